"""Frames count only where the servo's log knows the base, by the clock that the seen root tells."""

import numpy as np
import pytest

from inference.known_base import within_log
from inference.observation import POSE, ShapeObservation
from tentacle.base_motion import BaseMotion, fit_samples

SECONDS, RATE, NOISE = 10.0, 60.0, 1e-3  # s, frames/s, rad
ORDER = 2


def swinging(stop: float = SECONDS) -> BaseMotion:
    """0.5 rad at 0.7 and 1.3 Hz: it moves at both ends of the log."""
    t = np.arange(0.0, stop + 0.005, 0.01)
    return fit_samples(t, 0.3 * np.sin(2 * np.pi * 0.7 * t) + 0.2 * np.sin(2 * np.pi * 1.3 * t + 0.4))


def filmed(motion: BaseMotion, offset: float, drift: float) -> ShapeObservation:
    """A straight arm whose root follows the base, seen by another clock."""
    t = np.arange(0.0, SECONDS + 0.5 / RATE, 1.0 / RATE)
    logged = motion(np.clip(t, motion.start, motion.stop))[0]
    shown = motion(np.clip(t + offset + drift * t, motion.start - 0.5, motion.stop + 0.5))[0]
    coefficients = np.zeros((t.size, POSE + ORDER))
    coefficients[:, 0] = shown - logged + NOISE * np.random.default_rng(1).standard_normal(t.size)
    root = np.repeat(np.eye(POSE + ORDER)[None] / NOISE, t.size, axis=0)
    return ShapeObservation(t, logged, 0.14, coefficients, root, np.zeros(t.size), np.zeros(t.size))


@pytest.mark.parametrize(("offset", "drift"), [(0.05, 0.0), (-0.05, 0.0), (0.02, 5e-4)])
def test_frames_beyond_the_log_by_the_camera_s_clock_are_left_out(offset: float, drift: float) -> None:
    motion = swinging()
    kept, count = within_log(filmed(motion, offset, drift), motion)
    shown = kept.t + offset + drift * kept.t
    beyond = (shown > motion.stop) | (shown < motion.start)
    # The shift is known to NOISE over the rate's rms and the root of the frames: about .03 ms. A frame lasts 17 ms.
    assert abs(count - int(beyond.sum())) <= 1
    assert not np.any(kept.seen & (shown > motion.stop + 0.002))


def test_one_clock_leaves_every_frame() -> None:
    motion = swinging()
    assert within_log(filmed(motion, 0.0, 0.0), motion)[1] == 0


def test_a_base_that_rests_at_the_end_rests_on() -> None:
    t = np.arange(0.0, 6.0, 0.01)
    motion = fit_samples(t, 0.3 * np.sin(np.pi * t) ** 3 * (t < 4.0))
    _, count = within_log(filmed(motion, 0.05, 0.0), motion)
    assert count == 0
