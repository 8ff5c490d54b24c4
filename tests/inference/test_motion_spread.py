"""The spread of a motion, seen through frames of any noise."""

import numpy as np
import pytest

from inference.motion_spread import likely_shapes, motion_spread, spread
from inference.observation import POSE, ShapeObservation


@pytest.mark.parametrize("noise", [0.01, 1.0, 3.0])
def test_the_spread_is_that_of_the_motion_and_not_of_its_noise(noise: float) -> None:
    """tau of 4000 values scatters by tau (1 + noise^2 / tau^2) / sqrt(8000); 5 of these are asked."""
    random, tau, count = np.random.default_rng(0), np.array([0.5, 1.0]), 4000
    seen = tau * random.standard_normal((count, 2)) + noise * random.standard_normal((count, 2))
    found = spread(seen, np.repeat(noise**-2.0 * np.eye(2)[None], count, axis=0))
    np.testing.assert_array_less(np.abs(found - tau), 5.0 * tau * (1.0 + noise**2 / tau**2) / np.sqrt(2.0 * count))


def test_a_coordinate_that_no_frame_shows_begins_where_the_motion_is() -> None:
    """z_1 is seen to .01 rad, z_2 to 5 rad, and neither moves by more than .3 rad."""
    random, frames, count = np.random.default_rng(1), 400, POSE + 2
    t = np.arange(frames) / 60.0
    truth = 0.3 * np.stack([np.sin(3.0 * t), np.cos(3.0 * t)], axis=1)
    noise = np.array([0.01, 5.0])
    coefficients, root = np.zeros((frames, count)), np.zeros((frames, count, count))
    coefficients[:, POSE:] = truth + noise * random.standard_normal((frames, 2))
    root[:] = np.diag([*np.ones(POSE), *(1.0 / noise)])
    nothing = np.zeros(frames)
    observation = ShapeObservation(t, nothing, 0.14, coefficients, root, nothing, nothing)
    shape, rate = motion_spread(observation)
    assert shape[0] == pytest.approx(0.3 / np.sqrt(2.0), rel=0.1)  # rms of a sine, over 3 of its periods
    assert rate[0] == pytest.approx(0.9 / np.sqrt(2.0), rel=0.1)
    assert shape[1] < 2.5  # 300 frames of 5 rad leave a variance open by 25 sqrt(2 / 300) = 2 rad^2; 3 of these
    likely = likely_shapes(observation, np.arange(6), shape)
    np.testing.assert_allclose(likely[:, 0], truth[:6, 0], atol=0.05)  # 5 sigma
    assert np.abs(likely[:, 1]).max() < 3.0  # 2.5^2 / (2.5^2 + 5^2) of 3 times the raw 5 rad
