"""What trials like a recording take from it: found again where it is known."""

from dataclasses import replace

import numpy as np
import pytest

from tentacle.errors import InputError
from tentacle.waveform import Sine
from tests.made_recordings import FPS, TRUTH, WAVE, S
from validation.trials.design import BASE_SPREAD, Design, designs
from validation.trials.likeness import AFTER, BEFORE, likeness, sampled_motion
from validation.trials.sight import Measurement, track_noise


@pytest.fixture(scope="module")
def alike(recorded):
    return likeness(recorded(noise=2e-4))


def test_arm_motion_length_and_noise_are_the_recording_s(alike):
    assert alike.sight.kind == "midline"
    # 480 frames of 42 coordinates, of which eight or so are the shape's: their noise is known to 2 %.
    assert alike.sight.noise == pytest.approx(2e-4, rel=0.1)
    assert alike.sight.stated == 2e-4
    np.testing.assert_allclose(alike.sight.s, S)
    assert alike.fps == pytest.approx(FPS)
    assert alike.duration == pytest.approx(8.0 - 1.0 / FPS, abs=1.01 / FPS)
    for (effect, name), value in TRUTH.items():
        assert alike.model.value(effect, name) == pytest.approx(value, rel=0.03)
    t = np.linspace(0.0, 7.9, 500)
    (design,) = designs(1, 0, ("wall",), ("magnet",), alike, ["null"])
    np.testing.assert_allclose(design.waveform()(t)[0], WAVE(t)[0], atol=2e-4)  # a log at 60 Hz holds no more


def test_designs_share_all_but_the_base_parameters_and_what_is_hidden(alike):
    found = designs(32, 1, ("wall", "current"), ("magnet",), alike)
    assert {design.sight for design in found} == {alike.sight}
    assert {design.duration for design in found} == {alike.duration}
    ratios = np.array([design.model().value("elasticity", "E") for design in found])
    ratios /= alike.model.value("elasticity", "E")
    assert BASE_SPREAD[0] <= ratios.min() < 0.9 < 1.1 < ratios.max() <= BASE_SPREAD[1]
    assert [Design.of(design.table()) for design in found] == found


def test_a_motion_goes_on_beyond_the_frames_without_a_jump():
    """Point reflection about an end keeps angle and rate, and turns the curve's bend about."""
    wave = Sine(0.4, 0.7, 0.3)
    motion = sampled_motion(wave, 3.0, 8.0)
    t, angle = np.array(motion["t_s"]), np.array(motion["angle_rad"])
    assert t[0] == pytest.approx(-BEFORE)
    assert t[-1] == pytest.approx(5.0 + AFTER, abs=0.011)
    inside = (t >= 0.0) & (t <= 5.0)
    np.testing.assert_allclose(angle[inside], wave(t[inside] + 3.0)[0], atol=1e-12)
    # A rate that jumped would show as a step of the differences; this one changes by acceleration times the interval.
    assert np.abs(np.diff(angle, 2)).max() < 1.05 * 0.4 * (2.0 * np.pi * 0.7) ** 2 * 0.01**2


def test_a_track_s_noise_has_the_stated_covariance_times_its_gain():
    root = np.array([[1e-3, 0.0, 0.0], [4e-4, 2e-3, 0.0], [-3e-4, 8e-4, 3e-3]])
    covariance = root @ root.T
    rows = tuple(tuple(row) for row in covariance.tolist())
    sight = Measurement("track", 1e-5, covariance=rows, gain=(1.0, 1.0, 1.0))
    errors = track_noise(sight, 40000, np.random.default_rng(0))
    # Variances of 40 000 draws scatter by .7 %; five of those.
    scale = np.sqrt(np.diag(covariance))
    np.testing.assert_allclose(
        np.cov(errors.T) / np.outer(scale, scale), covariance / np.outer(scale, scale), atol=0.04
    )
    doubled = track_noise(replace(sight, gain=(2.0, 2.0, 2.0)), 40000, np.random.default_rng(0))
    np.testing.assert_allclose(doubled, 2.0 * errors, rtol=1e-9)


def test_a_recording_whose_base_stands_still_has_nothing_like_it(without_motion):
    with pytest.raises(InputError, match="--like"):
        likeness(without_motion)
