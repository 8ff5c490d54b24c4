"""The search for a law: a magnet that the reference hides is found as what it is, and nothing is found in noise."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from affine_model.arm import parameter_index
from discovery.laws.grammar import Scale, forms
from discovery.laws.operating_point import settled_search, sought_at, stiff_point, with_parameters
from discovery.laws.propose import _beside_laws, _by_name, _fitted_closely, _with_law, as_found, propose_laws
from discovery.laws.search import search_laws
from inference.base_fit import Setting, fit_base
from inference.prepare import prepare
from mujoco_ref.undeclared import make_recording
from mujoco_ref.undeclared.make import Scenario
from tentacle.io.effect_file import effect_text, effects_of, read_effects
from tentacle.law.in_use import using
from tentacle.model import Estimate, Model
from tentacle.specimen import WATER, Cone, Gravity, Specimen
from tentacle.waveform import Chirp

MAGNET = Path(__file__).parents[2] / "examples" / "effects" / "magnet.toml"
PLACE = (0.05, 0.15)  # m
MODULUS = 2e5  # Pa
MODEL = Model(Specimen(Cone(0.011, 0.004), 0.14, 1070.0), WATER)


def recording(strength):
    """12 s of the reference, with a magnet of that pull at 5 cm [N] beside the tip."""
    parameters = {"elasticity": {"E": MODULUS}, "damping": {"eta": 3e3}, "drag": {"C_perp": 1.1}}
    if strength:
        parameters["magnet"] = {"F": strength, "place_x": PLACE[0], "place_y": PLACE[1]}
    exact = {name: {k: Estimate.exact(v) for k, v in values.items()} for name, values in parameters.items()}
    with effects_of([MAGNET]):
        made, _ = make_recording(
            {}, Scenario(replace(MODEL, parameters=exact), Chirp(0.45, 0.4, 2.0, 12.0), 12.0, 50.0), 3
        )
    return made


@pytest.fixture(scope="module")
def magnet():
    prepared = prepare(recording(0.004), hold_out=True)
    return fit_base(Setting(prepared.recording.declaration, (prepared.experiment,), 4), 4)


@pytest.fixture(scope="module")
def found(magnet):
    return search_laws(sought_at(magnet)[1])


def test_small_motions_under_the_missing_force_are_what_was_seen(magnet):
    _, sought = sought_at(magnet)
    (one,) = sought.seen
    whole = one.small.freed(one.small.answer(one.motion.force[:, :, None]))[:, 0]
    # What the missing force itself does not explain is noise, of unit variance; of ten values a frame, two frames
    # a cell, a smoother that follows four coordinates in every cell takes up a fifth at most.
    assert np.sqrt(0.8) - 0.05 < np.sqrt(np.mean((sought.target - whole) ** 2)) < 1.1
    assert np.sqrt(np.mean(sought.target**2)) > 3.0


def test_a_magnet_is_found_with_its_power_and_its_place(found):
    best = found[0]
    assert best.form.law.name == "attraction"
    # Power within .1 and place within 5 % of the length: what is asked of laws.
    assert best.values["power"] == pytest.approx(2.0, abs=0.1)
    assert np.hypot(best.values["at_x"] - PLACE[0], best.values["at_y"] - PLACE[1]) < 0.05 * 0.14
    assert best.evidence - found[1].evidence > 100.0


@pytest.mark.long
def test_a_law_is_found_from_parameters_that_the_missing_force_has_moved_far(magnet):
    # A fit without the law can end anywhere: here with a hundredth of the stiffness and no drag.
    lost = with_parameters(magnet, {("elasticity", "E"): MODULUS / 100.0, ("drag", "C_perp"): 0.0})
    motions, _ = sought_at(lost)
    stiff = stiff_point(lost, motions)[1].parameters[parameter_index("elasticity", "E")]
    # Four times the balance of inertia and weight: near the arm's own, less where a magnet's pull bends it as much.
    assert MODULUS / 5.0 < stiff < 5.0 * MODULUS
    searched = settled_search(lost, motions)
    best = searched.laws[0]
    assert best.form.law.name == "attraction"
    assert np.hypot(best.values["at_x"] - PLACE[0], best.values["at_y"] - PLACE[1]) < 0.05 * 0.14
    # The recording is of the reference's chain: the reduced model's best stiffness differs from it by a few per cent.
    assert searched.point[1].parameters[parameter_index("elasticity", "E")] == pytest.approx(MODULUS, rel=0.05)


@pytest.mark.long
def test_a_force_at_the_tip_gets_the_coordinates_that_it_needs():
    """A model of two coordinates is fitted to an arm that a magnet bends at its tip."""
    prepared = prepare(recording(0.004), hold_out=True)
    base = fit_base(Setting(prepared.recording.declaration, (prepared.experiment,), 2), 2)
    searched = settled_search(base, sought_at(base)[0])
    law = as_found(searched.laws[0])
    assert law.name == "law_attraction"
    there = _by_name(base[0], searched.point[1].parameters)
    with using([law]):
        rough = _with_law(_beside_laws(base[0], there), base[1], searched.laws[0], law)
        (close,) = _fitted_closely([rough], 1.0)
        values = [close.fitted.parameters[parameter_index(law.name, name)] for name in ("at_x", "at_y")]
    # The chain's higher modes are seen at .15 mm of noise once the magnet's place is free to excite them.
    assert close.problem.arm.order > 2
    assert rough.fitted.misfit - close.fitted.misfit > sum(close.problem.sizes()) - sum(rough.problem.sizes())
    assert np.hypot(values[0] - PLACE[0], values[1] - PLACE[1]) < 0.05 * 0.14  # what is asked of laws


def test_a_proposal_is_an_effect_file(found, tmp_path):
    law = as_found(found[0])
    file = tmp_path / "law.toml"
    file.write_text(effect_text(law))
    assert read_effects([file]) == (law,)


def test_where_the_force_is_noise_no_law_is_proposed():
    prepared = prepare(recording(0.0), hold_out=True)
    base = fit_base(Setting(prepared.recording.declaration, (prepared.experiment,), 4), 4)
    missing = propose_laws(base, [prepared])
    assert missing.laws == ()
    assert "no law is proposed" in missing.words[0]


def test_about_a_model_that_falls_over_no_law_is_sought(magnet):
    """An arm that stands up in a hundredfold gravity, and has no stiffness: its small motions grow e-fold in 10 ms."""
    problem, fitted = with_parameters(magnet, {("elasticity", "E"): 0.0, ("damping", "eta"): 0.0})
    heavy = Gravity(np.pi, 1000.0)
    assert not sought_at(magnet)[1].ran_away
    fallen = replace(problem, arm=replace(problem.arm, gravity=heavy))
    assert sought_at((fallen, fitted))[1].ran_away


def test_every_form_of_the_grammar_is_a_sound_law():
    names = [form.law.name for form in forms(Scale(0.14, True, 10.0))]
    assert len(set(names)) == len(names)
