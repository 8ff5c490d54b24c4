"""Laws that act at one section inside the arm: the bell bears the force of that section, and is sought only there."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from discovery.laws.grammar import Scale
from discovery.laws.inputs import LawInputs
from discovery.laws.inside import INNERMOST, OUTERMOST, inner_forms, inner_place
from discovery.laws.over import _levers, place_along
from discovery.laws.words import title_of
from inference.small_motions import SmallMotions
from tentacle.io.effect_file import effect_text, read_effects
from tests.discovery.test_laws_over import ARM, EVERY, N, T, swinging, with_force

FORMS = {form.law.name: form.law for form in inner_forms(Scale(0.14, wet=True, duration=20.0), 0.6)}
PLACES = pytest.mark.parametrize("s", [0.35, 0.5, 0.6, 0.75])


def forces(name, motion, values):
    """The generalised forces (T, n) of a law along that motion."""
    small = cast(SmallMotions, SimpleNamespace(motion=motion))
    return LawInputs(ARM, small, np.zeros(ARM.rule.s.size)).force(FORMS[name], values)


def near(found, exact):
    """Their difference, rms, over the rms of the exact one, whatever the common factor of at most 5 %."""
    factor = np.sum(found * exact) / np.sum(exact**2)
    assert factor == pytest.approx(1.0, abs=0.05)  # eight nodes give the bell its area to some per cent
    return np.linalg.norm(found / factor - exact) / np.linalg.norm(exact)


@PLACES
def test_a_drag_inside_is_that_of_its_section(s):
    motion = swinging()
    place = place_along(ARM, motion, s, EVERY)
    u_n = np.sum(place.velocity * place.normal, axis=1) / 0.1
    exact = _levers(ARM, motion.u, s) * (-0.01 * np.abs(u_n) * u_n)[:, None]
    assert near(forces("inside_drag", motion, {"a": 0.01, "power": 2.0, "at_s": s}), exact) < 0.04


@PLACES
def test_a_stop_inside_begins_where_its_section_passes_the_edge(s):
    motion = swinging()
    place, edge = place_along(ARM, motion, s, EVERY), 0.01
    across = np.zeros((T.size, N))  # dx/dz
    for j in range(N):
        ahead = motion.u.copy()
        ahead[:, j] += 1e-6
        moved = place_along(ARM, type(motion)(**{**vars(motion), "u": ahead}), s, EVERY)
        across[:, j] = (moved.position - place.position)[:, 0] / 1e-6
    exact = across * (-0.01 * np.maximum(place.position[:, 0] - edge, 0.0) / 0.014)[:, None]
    found = forces("inside_stop_right", motion, {"a": 0.01, "edge": edge, "power": 1.0, "at_s": s})
    assert near(found, exact) < 0.04


@pytest.mark.parametrize(("s", "found"), [(0.5, 0.5), (0.7, 0.7), (1.0, None)])
def test_one_inner_force_is_placed_and_one_at_the_tip_is_not(s, found):
    motion = with_force(swinging(), s, np.sin(3.0 * T))
    place = inner_place([ARM], [motion])
    assert place == (None if found is None else pytest.approx(found))


def test_forces_at_two_places_are_not_placed():
    motion, random = swinging(), np.random.default_rng(3)
    both = sum(
        with_force(motion, s, random.standard_normal(T.size) / np.linalg.norm(_levers(ARM, motion.u, s))).force
        for s in (0.3, 1.0)
    )
    assert inner_place([ARM], [type(motion)(**{**vars(motion), "force": both})]) is None


def test_its_words_and_its_file_state_the_section(tmp_path):
    law = FORMS["inside_attraction"]
    assert "the tip" not in law.title
    values = {"a": -0.01, "at_x": 0.05, "at_y": 0.1, "power": 2.0, "at_s": 0.58}
    assert title_of(law, values) == "a force at s = 0.58 away from a point, with a power of the distance"
    file = tmp_path / "law.toml"
    file.write_text(effect_text(law))
    assert read_effects([file]) == (law,)
    (place,) = (p for p in law.parameters if p.name == "at_s")
    assert place.bounds == (INNERMOST, OUTERMOST)
