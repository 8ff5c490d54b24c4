"""Trials whose noise is what the declared model leaves in a recording: its size, its slowness, and what is refused."""

from __future__ import annotations

import math
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


@pytest.fixture(scope="module")
def errors() -> OwnErrors:
    """Errors that die away, of two points."""
    t = np.arange(0.0, 8.0, 0.02)
    size = 1e-3 * np.exp(-t)[:, None, None] * np.array([[1.0, 0.5], [0.2, 2.0]])
    return OwnErrors(t, size, 0.4)


def test_drawn_errors_are_as_large_as_the_own_ones_at_every_time(errors: OwnErrors) -> None:
    random = np.random.default_rng(1)
    shares = np.array([errors.drawn(errors.t, random) for _ in range(400)]) / errors.xy
    assert np.abs(shares).max() <= 1.0 + 1e-12
    assert np.mean(np.abs(shares) > 0.9) == pytest.approx(0.8, abs=0.05)
    assert np.abs(shares.mean(axis=0)).max() < 4.0 / math.sqrt(400)  # either sign, at every time
    np.testing.assert_allclose(shares, np.broadcast_to(shares[..., :1, :1], shares.shape))  # one sign for all points


def test_neighbouring_errors_keep_their_sign_and_distant_ones_do_not(errors: OwnErrors) -> None:
    even, random = OwnErrors(errors.t, np.ones_like(errors.xy), errors.time), np.random.default_rng(2)
    drawn = np.array([even.drawn(even.t, random)[:, 0, 0] for _ in range(2000)])
    for lag in (0.1, 0.4, 2.0):
        later = round(lag / 0.02)
        found = np.mean(drawn[:, 0] * drawn[:, later])
        same = 2.0 / math.pi * math.asin(math.exp(-0.5 * (lag / 0.4) ** 2))  # of two signs (the arcsine law)
        assert found == pytest.approx(same, abs=0.15 * same + 4.0 / math.sqrt(2000))  # these turn smoothly


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
    left = noisy.xy - quiet.xy
    assert 0.3 * NOISE < np.sqrt(np.mean(left**2)) < 2.0 * NOISE  # one draw of the slow factor's mean square
    steps = np.diff(left[:, 10, 0])
    assert np.mean(steps**2) > np.mean(left[:, 10, 0] ** 2)  # white, as the own errors: a slow error would have none


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
