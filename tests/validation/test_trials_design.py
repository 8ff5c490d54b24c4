"""Designs of blind trials in plants and like a recording, and how their hidden effects are sized."""

import json
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from affine_model.arm import parameter_index, parameter_vector
from tentacle.errors import InputError
from tentacle.io.model_file import model_tables
from tests.validation.made_designs import MODEL, of_kind
from validation.plants.draw import FASTEST, SETTLED
from validation.plants.laws import LAWS, OUTSIDE
from validation.trials.design import Design
from validation.trials.plant_design import DURATION_RANGE, PlantDesign, plant_designs
from validation.trials.plant_recording import plant_recording
from validation.trials.recording import trial_recording
from validation.trials.rounds import TRIAL_KINDS, dealt
from validation.trials.sizing import bare_problem, left_by_refit, sized, visible_size


def test_a_longer_series_begins_with_the_shorter_one():
    assert plant_designs(40, 5)[:17] == plant_designs(17, 5)
    assert plant_designs(5, 5) != plant_designs(5, 6)


def test_a_design_survives_json():
    for design in (*plant_designs(8, 1), of_kind("wall")):
        assert type(design).of(json.loads(json.dumps(design.table()))) == design


def test_kinds_effects_plants_and_videos_come_in_their_shares():
    found = plant_designs(160, 2)
    kinds = Counter(design.kind for design in found)
    assert kinds == {"single": 90, "null": 20, "unknown": 20, "pair": 30}
    singles = Counter(design.effects[0] for design in found if design.kind == "single")
    assert max(singles.values()) - min(singles.values()) <= 1  # shuffled decks deal evenly
    assert set(singles) == set(LAWS)
    assert sum(design.seen == "video" for design in found) == 40
    assert {design.kind for design in found if design.seen == "video"} == set(TRIAL_KINDS)  # in turn, none is left out
    assert all(
        len(set(design.effects)) == {"single": 1, "pair": 2, "null": 0, "unknown": 1}[design.kind] for design in found
    )
    plants = Counter(design.plant for design in found)
    assert set(plants) == {"stranger", "chain"}
    assert min(plants.values()) > 50  # of 160 drawn evenly, 4.7 standard deviations below the mean
    assert {design.plant for design in plant_designs(9, 2, plants=["chain"])} == {"chain"}
    assert {one.kind for one in dealt(6, 2, tuple(LAWS), OUTSIDE, kinds=["null", "pair"])} == {"null", "pair"}


def test_motions_keep_within_the_servo_s_speed():
    for design in plant_designs(20, 3):
        t = np.linspace(SETTLED, SETTLED + design.seconds, 20001)
        theta = design.trial().theta(t)
        assert np.abs(np.gradient(theta, t)).max() <= FASTEST * 1.001
        assert np.abs(theta).max() > 0.05
        assert DURATION_RANGE[0] <= design.seconds <= DURATION_RANGE[1]


@pytest.mark.parametrize(
    ("field", "options"),
    [("kinds", {"kinds": ["triple"]}), ("video share", {"video_share": 1.5}), ("plant", {"plants": ["tank"]})],
)
def test_bad_options_are_refused(field, options):
    with pytest.raises(InputError, match=field):
        plant_designs(3, 0, **options)


def test_a_plant_s_recording_tells_nothing_of_its_truth_and_the_truth_tells_the_law():
    design = PlantDesign(3, 11, "single", ("camera_scale",), "stranger", "midline", 2.5, 1e-4)
    (recording, truth), (again, _) = plant_recording(design), plant_recording(design)
    np.testing.assert_array_equal(recording.midline.xy, again.midline.xy)
    assert recording.name == "trial_0003"
    assert set(truth["laws"]) == {"camera_scale"}
    assert truth["plant"] == "stranger"
    # A camera's scale is within no base parameter: what stays of it is of the size by which it moves the picture.
    assert truth["r"][0] > 0.3 * truth["moved_mm"] / truth["noise_mm"]
    json.dumps(truth)


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


def test_beside_a_baseline_the_arm_s_own_parameters_absorb_nothing():
    """A softer arm is what a refit absorbs, unless another recording shows how stiff it is."""
    alone = of_kind("buoyancy")
    for design, seen in ((alone, False), (replace(alone, baseline=("bare",)), True)):
        problem, nuisances = bare_problem(design)
        assert bool(problem.free) is not seen
        true = parameter_vector(design.model())
        unknowns = np.concatenate([problem.parameters[problem.rows()], nuisances])[:, None]
        softer = true.copy()
        softer[parameter_index("elasticity", "E")] *= 0.9
        bare, changed = (problem.residuals_everywhere(p[:, None], unknowns)[0][:, :, 0] for p in (true, softer))
        left = left_by_refit(problem, nuisances, changed - bare)
        assert (left > 1.0) is seen  # noise sigmas
        assert seen or left < 0.1


def test_the_arm_that_is_refitted_carries_the_water_that_is_declared():
    """A stiffness 30 times as large is within the base. Without the declared water the bare arm would move otherwise
    than the plant's, and R would be the difference between these two motions.
    """
    carried = replace(MODEL, fluid=replace(MODEL.fluid, added_mass="section"))
    design = Design.of({**of_kind("buoyancy").table(), "arm": model_tables(carried)})
    problem, nuisances = bare_problem(design)
    np.testing.assert_array_equal(problem.parameters, parameter_vector(carried))
    (experiment,) = problem.experiments
    stiffer, unknowns = (
        parameter_vector(carried)[:, None],
        np.concatenate([problem.parameters[problem.rows()], nuisances]),
    )
    stiffer[parameter_index("elasticity", "E")] *= 30.0
    bare = problem.residuals_everywhere(parameter_vector(carried)[:, None], unknowns[:, None])[0][:, :, 0]
    changed = problem.residuals_everywhere(stiffer, unknowns[:, None])[0][:, :, 0]
    assert np.sqrt(np.mean((changed - bare)[experiment.used] ** 2)) > 5.0  # noise sigmas: the stiffness is well seen
    assert left_by_refit(problem, nuisances, changed - bare) < 0.1


def test_an_effect_that_cannot_reach_r_keeps_within_its_limit():
    design = of_kind("skin_drag", r=[1e4])
    hidden, reached = sized(design)
    assert hidden["skin_drag"]["C_t"] <= 3.0
    assert reached[0] < 1e3


def test_a_recording_tells_nothing_of_its_truth_and_is_the_same_again():
    design = of_kind("time_offset", r=[3.0])
    recording, truth = trial_recording(design)
    again, _ = trial_recording(design)
    assert recording.name == "trial_0000"
    assert truth["kind"] == "single"
    assert set(truth["effects"]) == {"time_offset"}
    np.testing.assert_array_equal(recording.midline.xy, again.midline.xy)
    assert recording.midline.t[-1] == pytest.approx(12.0, abs=1 / 60)
