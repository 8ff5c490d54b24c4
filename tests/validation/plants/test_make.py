"""Plants for trials: the same seed gives the same recording; every effect by every law moves the arm; nothing hints."""

import json
import sys

import numpy as np
import pytest

from tentacle.errors import InputError
from validation.plants import make
from validation.plants.draw import Filming, drawn
from validation.plants.filmed import COARSE, Plant, film
from validation.plants.laws import LAWS, OUTSIDE
from validation.plants.rod import move

QUICK = {"filming": Filming(0.8, 25.0)}


def xy(made):
    return made[0].midline.xy


def test_the_same_seed_gives_the_same_recording_and_another_another():
    one, again, other = (make("stranger", seed, **QUICK) for seed in (4, 4, 5))
    np.testing.assert_array_equal(xy(one), xy(again))
    assert one[1] == again[1]
    assert one[1]["arm"] != other[1]["arm"]


@pytest.mark.parametrize("effect", [*LAWS, *OUTSIDE])
def test_every_effect_shows_by_each_of_its_laws(effect):
    seen = {}
    for law in LAWS.get(effect, (None,)):
        trial = drawn(3, (effect,), {effect: law} if law else {}, Filming(0.6, 25.0, 1e-4), (6.0, 15.0))
        bare, seen[law] = (film(trial, Plant(move, COARSE), hidden)[0] for hidden in ((), trial.hidden))
        assert np.abs(seen[law] - bare).max() > 2e-5  # m, at a typical strength
    first, *rest = seen.values()
    assert all(np.abs(first - other).max() > 0.0 for other in rest)


def test_a_hidden_effect_has_the_size_that_was_asked():
    recording, truth = make("stranger", 3, effects=("current",), size=(8.0, 8.0), **QUICK)
    assert truth["verdict"] == "effect"
    assert list(truth["effects"]) == list(truth["laws"]) == ["current"]
    assert truth["moved_mm"] == pytest.approx(8.0 * truth["noise_mm"], rel=0.15)  # sized to 10 %
    json.dumps(truth)
    assert "current" not in recording.name


def test_what_is_declared_is_the_arm_and_not_what_is_hidden():
    bare, hidden = (make("stranger", 7, effects=effects, **QUICK)[0] for effects in ((), ("tip_mass", "camera_roll")))
    assert bare.declaration == hidden.declaration
    np.testing.assert_array_equal(bare.motor.angle, hidden.motor.angle)


def test_about_half_of_the_declarations_hold_the_added_mass():
    carried = [drawn(seed, (), {}, Filming(1.0, 25.0, 1e-4), (6.0, 15.0)).carries for seed in range(60)]
    assert 20 < sum(carried) < 40


def test_drawn_trials_hold_every_kind():
    kinds = [
        tuple(h.effect for h in drawn(s, None, {}, Filming(1.0, 25.0, 1e-4), (6.0, 15.0)).hidden) for s in range(80)
    ]
    assert () in kinds
    assert any(kind and kind[0] in OUTSIDE for kind in kinds)
    assert {len(kind) for kind in kinds} == {0, 1, 2}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"plant": "tank", "seed": 0}, "plant"),
        ({"plant": "stranger", "seed": 0, "effects": ("gremlins",)}, "gremlins"),
        ({"plant": "stranger", "seed": 0, "effects": ("current",), "laws": {"current": "of gravity"}}, "current"),
    ],
)
def test_what_is_not_known_is_refused(arguments, words):
    with pytest.raises(InputError, match=words):
        make(**arguments)


def test_the_chain_s_links_are_drawn_and_both_plants_draw_the_same_arm():
    of_rod, of_chain = (make(plant, 6, effects=("current",), **QUICK)[1] for plant in ("stranger", "chain"))
    assert of_rod["arm"] == of_chain["arm"]
    assert of_rod["laws"] == of_chain["laws"]
    assert 24 <= of_chain["links"] <= 60


def test_a_plant_that_is_not_installed_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "elastica", None)
    with pytest.raises(InputError, match="PyElastica is not installed"):
        make("elastica", 0, effects=())
