"""Trials whose noise is what the declared model leaves in a recording: its size, its slowness, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tentacle.errors import InputError
from tentacle.io.recording_rrd import write_rrd
from validation.trials.design import Design, designs
from validation.trials.likeness import RealParts, declared_fit, likeness
from validation.trials.own_errors import OwnErrors, own_errors
from validation.trials.recording import trial_recording

NOISE = 2e-4


def test_errors_are_the_own_ones_at_every_frame_and_between_them() -> None:
    t = np.arange(0.0, 2.0, 0.02)
    xy = np.sin(3.0 * t)[:, None, None] * np.array([[1.0, 0.5], [0.2, 2.0]])
    errors = OwnErrors(t, xy)
    np.testing.assert_array_equal(errors.at(t), xy)
    between = np.sin(3.0 * (t[:-1] + 0.01))[:, None, None] * np.array([[1.0, 0.5], [0.2, 2.0]])
    # Linear between: off by (0.06)^2 / 8 of the size, which is 2, at most.
    assert np.abs(errors.at(t[:-1] + 0.01) - between).max() < 2.0 * 0.06**2 / 8.0 * 1.01


def test_a_trial_has_the_errors_of_the_recording(recorded, tmp_path: Path) -> None:
    """The recording's own errors are white here, of 0.2 mm: so are those of its trials, with nothing else in them."""
    recording = recorded(noise=NOISE)
    file = tmp_path / "made.rrd"
    write_rrd(recording, file)
    assert own_errors(*declared_fit(recording)).rms == pytest.approx(NOISE, rel=0.02)
    alike = likeness(recording, with_own_errors=True)
    assert alike.sight.noise == pytest.approx(NOISE, rel=0.02)
    (design,) = designs(1, 0, ("wall",), ("magnet",), replace(alike, real=RealParts(str(file))), ["null"])
    assert Design.of(design.table()) == design
    noisy = trial_recording(design)[0].midline
    quiet = trial_recording(replace(design, errors_of="", sight=replace(design.sight, noise=0.0)))[0].midline
    assert noisy is not None
    assert quiet is not None
    own = own_errors(*declared_fit(recording))
    # The trial's clock begins with the first used frame, to its rounding: errors of neighbours differ by 0.3 mm.
    np.testing.assert_allclose(noisy.xy - quiet.xy, own.at(noisy.t), atol=1e-9)


def test_beside_a_real_baseline_the_arm_is_that_of_the_recording(recorded) -> None:
    alike = likeness(recorded(noise=NOISE))
    varied, same = (
        designs(1, 3, ("wall",), ("magnet",), replace(alike, real=RealParts(baseline=paths)), ["null"])[0]
        .model()
        .parameters
        for paths in ((), ("bare",))
    )
    assert same["elasticity"]["E"].value == alike.model.parameters["elasticity"]["E"].value
    assert varied["elasticity"]["E"].value != same["elasticity"]["E"].value


def test_a_track_has_no_points_whose_errors_could_be_taken(recorded) -> None:
    prepared, problem, fitted = declared_fit(recorded(noise=NOISE))
    bare = replace(prepared, recording=replace(prepared.recording, midline=None))
    with pytest.raises(InputError, match="neither a midline nor markers"):
        own_errors(bare, problem, fitted)
