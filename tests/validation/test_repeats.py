"""Repeats of one arm: its own laws act on both days, what is hidden on one, and the answer tells them apart."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from validation.plants import PLANTS
from validation.plants.filmed import film
from validation.plants.repeats import OWN, SPREAD, repeated, with_own_laws
from validation.trials.plant_design import MOVES, PlantDesign, plant_designs
from validation.trials.plant_recording import plant_baseline, plant_recording
from validation.trials.series import trial

DESIGN = PlantDesign(3, 11, "single", ("camera_scale",), "stranger", "midline", 2.5, 1e-4, ("viscoelasticity",))


def test_own_laws_are_one_or_two_and_none_of_them_is_hidden():
    for design in plant_designs(48, 4, repeats=True):
        assert 1 <= len(design.own) <= 2
        assert set(design.own) <= set(OWN) - set(design.effects)
        assert PlantDesign.of(json.loads(json.dumps(design.table()))) == design
    assert not any(design.own for design in plant_designs(16, 4))


def test_the_other_day_has_the_same_arm_and_laws_and_another_motion():
    first = DESIGN.trial()
    plant = PLANTS[DESIGN.plant](first)
    one = with_own_laws(first, plant, DESIGN.own, MOVES)
    other = repeated(one)
    assert other.own == one.own
    assert other.hidden == ()
    for name, value in one.arm.items():
        # Four standard deviations of the spread: one draw in 16 000 is beyond.
        assert abs(other.arm[name] / value - 1.0) <= (4.0 * SPREAD if name in ("E", "eta") else 0.0)
    assert np.abs(other.theta(np.linspace(0.0, 4.0, 50)) - one.theta(np.linspace(0.0, 4.0, 50))).max() > 0.05
    # The own law moves the midline in both, as far as it was asked to in the first: from 1 to 15 sigmas, to a tenth.
    moved = [film(day, plant, ())[0] - film(replace(day, own=()), plant, ())[0] for day in (one, other)]
    first_rms, other_rms = (np.sqrt(np.mean(np.sum(m**2, axis=2))) / one.sigma for m in moved)
    assert 0.9 < first_rms < 16.5
    assert other_rms > 0.1 * first_rms


def test_a_baseline_s_recording_tells_nothing_of_its_laws_and_the_truth_keeps_them_apart():
    recording, truth = plant_recording(DESIGN)
    (baseline,) = plant_baseline(DESIGN)
    assert set(truth["effects"]) == {"camera_scale"}
    assert set(truth["own"]) == {"viscoelasticity"}
    assert baseline.declaration == recording.declaration
    assert baseline.declaration.specimen.laws == ()
    assert plant_baseline(replace(DESIGN, own=())) == []


@pytest.mark.long
@pytest.mark.parametrize(
    ("index", "verdict", "effects", "own"),
    [(8, "nothing_missing", [], "cubic_stiffness"), (13, "effect", ["viscoelasticity"], "amplitude_damping")],
)
def test_a_law_that_a_recording_shows_is_the_arms_own_if_it_acts_in_the_baseline_too(index, verdict, effects, own):
    """Trial 8: the cubic stiffness acts on both days, but the baseline alone does not show it. Trial 13: the memory is
    hidden in the recording alone, and the damping acts in both.
    """
    design = plant_designs(index + 1, 32, video_share=0.0, repeats=True)[index]
    result = trial(design.table())
    assert result["truth"]["verdict"] == verdict
    answer = result["answer"]
    assert (answer["verdict"], [name for name in answer["effects"] if name != "third_curvature"]) == (verdict, effects)
    assert any(f"{own}" in words and "the arm's own law" in words for words in answer["words"])
