"""A frame that is shown twice is found, and the frames around it are kept."""

import numpy as np

from inference.jumps import jumping_frames, without_jumps
from inference.observation import POSE, ShapeObservation


def swinging(frames=120, rate=30.0, missing=()):
    t = np.delete(np.arange(frames + len(missing)) / rate, missing)
    random = np.random.default_rng(3)
    coefficients = np.zeros((frames, POSE + 2))
    sigma = np.array([1e-3, 1e-4, 1e-4, 1e-3, 5e-3, 1e-2])
    coefficients[:, POSE] = 0.3 * np.sin(2 * np.pi * 1.2 * t)
    coefficients[:, POSE + 1] = 0.2 * np.cos(2 * np.pi * 1.2 * t)
    coefficients += sigma * random.standard_normal(coefficients.shape)
    root = np.repeat(np.diag(1.0 / sigma)[None], frames, axis=0)
    theta = 0.4 * np.sin(2 * np.pi * 1.2 * t + 0.5)
    nothing = np.zeros(frames)
    return ShapeObservation(t, theta, 0.14, coefficients, root, nothing, nothing)


def test_a_motion_without_jumps_keeps_every_frame():
    # At 4 times the scatter around it, no frame of 120 with Gaussian noise stands out.
    assert not jumping_frames(swinging()).any()


def test_a_frame_shown_twice_is_left_out_and_it_alone():
    observation = swinging()
    # The picture of frame 59 once more: its shape, and the base angle it had then, counted from the servo's angle now.
    observation.coefficients[60] = observation.coefficients[59]
    observation.coefficients[60, 0] += observation.theta[59] - observation.theta[60]
    assert np.flatnonzero(jumping_frames(observation)).tolist() == [60]
    cleaned, count = without_jumps(observation)
    assert count == 1
    assert np.flatnonzero(cleaned.root[:, -1, -1] == 0.0).tolist() == [60]


def test_frames_that_are_shifted_as_a_whole_are_left_out():
    """By 5 mm, 50 standard deviations and half of the motion between frames: of what was tracked for one picture."""
    observation, wrong = swinging(), [30, 61, 90]
    observation.coefficients[wrong, 1] += [5e-3, -5e-3, 5e-3]
    assert np.flatnonzero(jumping_frames(observation)).tolist() == wrong


def test_frames_beside_missing_ones_are_kept_and_one_shown_twice_is_found_among_them():
    """Every ninth frame is missing, and seven in a row."""
    missing = sorted({*range(8, 400, 9), *range(200, 207)})
    observation = swinging(frames=400 - len(missing), missing=missing)
    assert not jumping_frames(observation).any()
    observation.coefficients[58] = observation.coefficients[57]
    observation.coefficients[58, 0] += observation.theta[57] - observation.theta[58]
    assert np.flatnonzero(jumping_frames(observation)).tolist() == [58]
