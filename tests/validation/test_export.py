from dataclasses import replace

import numpy as np
import pytest

from mujoco_ref.export.mjcf import export_mjcf
from mujoco_ref.undeclared import Noise, Scenario, make_recording
from tentacle.errors import InputError
from tentacle.signals import Markers
from tentacle.waveform import Ramped, Sine
from tests.mujoco_ref.arms import swimming_model
from validation.export.in_mujoco import export_error
from validation.export.start import start_of

WAVE = Ramped(Sine(0.4, 1.3), 0.5)


@pytest.fixture(scope="module")
def model():
    return replace(swimming_model(added_mass={"C_a": 1.0}, camera_roll={"roll": 0.03}), order=3)


@pytest.fixture(scope="module")
def recording(model):
    plain = replace(model, parameters={k: v for k, v in model.parameters.items() if k != "camera_roll"})
    hidden = {"camera_roll": {"roll": 0.03}}
    return make_recording(hidden, Scenario(plain, WAVE, 2.5, 60.0), 0, Noise(midline=1.5e-4), name="made")[0]


def test_mujoco_shows_the_recording_as_well_as_ours(model, recording):
    found = export_error(export_mjcf(model, 10).xml, model, recording)
    assert found.ours_mm < 0.5
    assert found.with_forces_mm < 1.1 * found.ours_mm
    assert "times ours" in found.sentence()


def test_behind_a_clamp_that_gives_mujoco_shows_the_recording_as_well_as_ours(model):
    giving = replace(model, specimen=replace(model.specimen, clamp_length=0.014))
    plain = replace(giving, parameters={k: v for k, v in model.parameters.items() if k != "camera_roll"})
    hidden = {"camera_roll": {"roll": 0.03}}
    seen = make_recording(hidden, Scenario(plain, WAVE, 2.5, 60.0), 0, Noise(midline=1.5e-4), name="made")[0]
    found = export_error(export_mjcf(giving, 10).xml, giving, seen)
    assert found.ours_mm < 0.5
    assert found.with_forces_mm < 1.1 * found.ours_mm


def test_markers_beside_the_axis_are_compared_where_they_are(model, recording):
    line = recording.midline
    at = [8, 20]
    tangent = np.gradient(line.xy, axis=1)[:, at]
    normal = np.stack([tangent[..., 1], -tangent[..., 0]], axis=2) / np.linalg.norm(tangent, axis=2, keepdims=True)
    d = np.array([0.003, -0.003])
    marks = Markers(line.t, ("a", "b"), line.s[at], d, line.xy[:, at] + d[:, None] * normal)
    found = export_error(export_mjcf(model, 10).xml, model, replace(recording, midline=None, markers=marks))
    assert found.with_forces_mm < 1.1 * found.ours_mm


def test_a_recording_that_shows_no_arm_is_refused(model, recording):
    with pytest.raises(InputError, match="no midline and no markers"):
        export_error(export_mjcf(model, 10).xml, model, replace(recording, midline=None))


@pytest.mark.long
def test_a_start_of_many_coordinates_is_one_that_any_discretisation_follows(model, recording):
    """Shapes that die within a frame are seen by no frame: their rates come from the prior, not from the noise."""
    six = replace(model, order=6)
    started = start_of(six, recording)
    rate = np.polynomial.polynomial.polyval(np.linspace(0.0, 1.0, 51), started.q_rate)
    # The base turns by at most .4 * 2 pi * 1.3 = 3.3 rad/s; without the prior the tip starts at 1500.
    assert np.abs(rate).max() < 30.0
    errors = [export_error(export_mjcf(six, links).xml, six, recording).with_forces_mm for links in (12, 24)]
    assert max(errors) < 1.05 * started.error_mm  # noise of .15 mm in both, which no discretisation follows
