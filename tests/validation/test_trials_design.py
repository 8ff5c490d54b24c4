"""Designs of blind trials, and how their hidden effects are sized."""

from collections import Counter

import numpy as np
import pytest

from tentacle.errors import InputError
from tentacle.recording import Declaration, Recording
from tentacle.signals import ShapeTrack
from validation.trials.design import DURATIONS, FASTEST, KINDS, VIDEO_NOISE, Design, Hideable, designs
from validation.trials.recording import _tracked_size, trial_recording
from validation.trials.sight import Sight
from validation.trials.sizing import bare_problem, sized, visible_size

INSIDE, OUTSIDE = ("wall", "current", "buoyancy", "added_mass"), ("magnet", "thread")


def test_a_longer_series_begins_with_the_shorter_one():
    assert designs(40, 5, Hideable(INSIDE, OUTSIDE))[:17] == designs(17, 5, Hideable(INSIDE, OUTSIDE))
    assert designs(5, 5, Hideable(INSIDE, OUTSIDE)) != designs(5, 6, Hideable(INSIDE, OUTSIDE))


def test_a_design_survives_json():
    import json

    for design in designs(8, 1, Hideable(INSIDE, OUTSIDE)):
        assert Design.of(json.loads(json.dumps(design.table()))) == design


def test_kinds_effects_and_videos_come_in_their_shares():
    found = designs(160, 2, Hideable(INSIDE, OUTSIDE))
    kinds = Counter(design.kind for design in found)
    assert kinds == {"single": 90, "null": 20, "unknown": 20, "pair": 30}
    singles = Counter(design.effects[0] for design in found if design.kind == "single")
    assert max(singles.values()) - min(singles.values()) <= 1  # shuffled decks deal evenly
    assert sum(design.sight.kind == "video" for design in found) == 40
    assert {design.kind for design in found if design.sight.kind == "video"} == set(KINDS)  # in turn, none is left out
    assert all(
        len(set(design.effects)) == {"single": 1, "pair": 2, "null": 0, "unknown": 1}[design.kind] for design in found
    )
    assert {design.kind for design in designs(6, 2, Hideable(INSIDE, OUTSIDE), kinds=["null", "pair"])} == {
        "null",
        "pair",
    }


def test_motions_keep_within_the_servo_s_speed():
    for design in designs(30, 3, Hideable(INSIDE, OUTSIDE)):
        theta, rate, _ = design.waveform()(np.linspace(0.0, design.duration, 20001))
        assert np.abs(rate).max() <= FASTEST * 1.001
        assert np.abs(theta).max() > 0.05
        assert DURATIONS[0] <= design.duration <= DURATIONS[1]
        assert 0.1 <= design.model().specimen.section.tip_radius / design.model().specimen.section.base_radius <= 0.5


@pytest.mark.parametrize(
    ("field", "options"), [("kinds", {"kinds": ["triple"]}), ("video share", {"video_share": 1.5})]
)
def test_bad_options_are_refused(field, options):
    with pytest.raises(InputError, match=field):
        designs(3, 0, Hideable(INSIDE, OUTSIDE), **options)


def of_kind(effect, **changed):
    design = designs(1, 4, Hideable((effect,), OUTSIDE), kinds=["single"], video_share=0.0)[0]
    return Design.of({**design.table(), "duration": 12.0, **changed})


def test_r_is_linear_in_a_faint_effect_and_reached_as_asked():
    """R is an rms of a linear response where the effect is small, and the sizing inverts it."""
    design = of_kind("buoyancy", r=[0.5])
    hidden, reached = sized(design)
    assert reached == pytest.approx([0.5], rel=0.1)  # sized until within 5 %, or five corrections
    strength = hidden["buoyancy"]["density_error"]
    problem, nuisances = bare_problem(design)
    variants = [{"density_error": factor * strength} for factor in (0.0, 0.5, 1.0, 2.0)]
    sizes = visible_size(problem, nuisances, "buoyancy", variants)
    assert sizes[0] == pytest.approx(0.0, abs=1e-9)
    # So faint an effect acts linearly, to 2 %; and a real refit leaves what the first order says, to 10 %.
    np.testing.assert_allclose(sizes[1:], sizes[2] * np.array([0.5, 1.0, 2.0]), rtol=0.02)
    assert sizes[2] == pytest.approx(reached[0], rel=0.1)


def test_what_refitting_absorbs_has_no_r():
    """A drag coefficient's change is what the base refits: R of it is of second order."""
    design = of_kind("buoyancy")
    problem, nuisances = bare_problem(design)
    changed = [{"C_perp": design.model().value("drag", "C_perp") * factor} for factor in (1.02, 1.04)]
    small, twice = visible_size(problem, nuisances, "drag", changed)
    assert twice == pytest.approx(4.0 * small, rel=0.3)


def test_an_effect_that_cannot_reach_r_keeps_within_its_limit():
    design = of_kind("skin_drag", r=[1e4])
    hidden, reached = sized(design)
    assert hidden["skin_drag"]["C_t"] <= 3.0
    assert reached[0] < 1e3


def test_r_of_a_video_goes_by_the_tracker_s_covariance():
    """A tracker twice as sure shows every effect twice as large; frames that it rejects say nothing."""
    design = of_kind("buoyancy", sight=Sight("video", VIDEO_NOISE).table())
    model, t = design.model(), np.arange(0.0, 3.0, 1.0 / 30.0)
    accepted = np.arange(t.size) % 7 != 3
    found = []
    for sigma in (4e-4, 2e-4):
        coefficients = np.where(accepted[:, None], 0.1 * np.ones((t.size, 5)), np.nan)
        covariance = np.repeat(sigma**2 * np.eye(5)[None], t.size, axis=0)
        track = ShapeTrack(
            t, coefficients, covariance, accepted, ("",) * t.size, 1.0, float("nan"), np.zeros(2)
        )  # fmt: skip
        recording = Recording("trial", Declaration(model.specimen, model.fluid), shape=track)
        found += _tracked_size(recording, design, {"buoyancy": {"density_error": 20.0}})
    assert found[1] == pytest.approx(2.0 * found[0], rel=0.02)  # the priors' share changes a little
    assert found[0] > 0.0


def test_a_recording_tells_nothing_of_its_truth_and_is_the_same_again():
    design = of_kind("time_offset", r=[3.0])
    recording, truth = trial_recording(design)
    again, _ = trial_recording(design)
    assert recording.name == "trial_0000"
    assert truth["kind"] == "single"
    assert set(truth["effects"]) == {"time_offset"}
    np.testing.assert_array_equal(recording.midline.xy, again.midline.xy)
    assert recording.midline.t[-1] == pytest.approx(12.0, abs=1 / 60)
