"""The time scale of a motion is that of the data: rms over the rms of the rate."""

import numpy as np
import pytest

from inference.experiment import Experiment
from inference.marker_observation import MarkerObservation
from inference.motion_time import motion_time, moved_until
from inference.observation import POSE, ShapeObservation
from tentacle.waveform import Sine

OMEGA = 2.0 * np.pi * 1.3


def experiment(observation, release=None):
    used = np.ones(observation.t.size, dtype=bool)
    return Experiment("made", observation, Sine(0.3, 1.3), 0.0, 20.0, release, used, np.ones(2))


def shapes(t, z, theta, noise):
    coefficients = np.zeros((t.size, POSE + 2))
    coefficients[:, POSE] = z + noise * np.random.default_rng(1).standard_normal(t.size)
    root = np.repeat(np.eye(POSE + 2)[None], t.size, axis=0)
    return ShapeObservation(t, theta, 0.14, coefficients, root, np.zeros(t.size), np.zeros(t.size))


@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_a_swing_has_the_inverse_of_its_angular_frequency(noise):
    t = np.arange(0.0, 20.0, 1 / 60)
    seen = shapes(t, 0.2 * np.sin(OMEGA * t + 0.4), 0.3 * np.sin(OMEGA * t), noise)
    # Over two frames a derivative keeps 1 - (omega dt)^2 / 6 = .997 of itself; the noise is known to 1 / sqrt(T).
    assert motion_time(experiment(seen)) == pytest.approx(1.0 / OMEGA, rel=0.01)


def test_gaps_in_the_frames_do_not_matter():
    t = np.arange(0.0, 20.0, 1 / 60)
    t = t[(t < 6.0) | (t > 9.0)]
    xy = 0.02 * np.sin(OMEGA * t)[:, None, None] * np.array([[1.0, 0.3]]) + np.array([[0.1, 0.05]])
    markers = MarkerObservation(t, np.zeros(t.size), 0.14, np.ones(1), np.zeros(1), xy, 1e-5)
    assert motion_time(experiment(markers)) == pytest.approx(1.0 / OMEGA, rel=0.01)


def test_a_decay_counts_from_its_release():
    t = np.arange(0.0, 6.0, 1 / 120)
    swings = np.where(t < 3.0, 0.2, 0.2 * np.exp(-0.5 * (t - 3.0)) * np.cos(OMEGA * (t - 3.0)))
    held = motion_time(experiment(shapes(t, swings, 0.0 * t, 0.0), release=3.0))
    after = t >= 3.0
    free = motion_time(experiment(shapes(t[after], swings[after], 0.0 * t[after], 0.0), release=3.0))
    assert held == pytest.approx(free, rel=1e-9)


@pytest.mark.parametrize("share", [0.25, 0.5])
def test_of_a_rising_frequency_the_motion_comes_late(share):
    """theta = a sin(k t^2): the square of the rate grows as t^2, so that its integral has a share (t / T)^3 by t."""
    t = np.arange(0.0, 20.0, 1 / 240)
    rising = 0.3 * np.sin(0.6 * t**2)
    found = moved_until(experiment(shapes(t, 0.0 * t, rising, 0.0)), share)
    # It comes in swings of pi / omega = .2 s there, between which nothing moves.
    assert found == pytest.approx(20.0 * share ** (1.0 / 3.0), abs=0.2)
