"""The base motion from samples: as near to the true angle, rate and acceleration as the samples let it be."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import make_lsq_spline

from tentacle.base_motion import fit_base_motion, fit_samples
from tentacle.errors import InputError
from tentacle.signals import Array, MotorSignal
from tentacle.waveform import Chirp, Multisine

MOTION = Multisine((0.5, 0.2, 0.1), (0.6, 1.3, 2.2), (0.0, 1.0, 2.0))
SECONDS = 8.0


def sample(rate: float, noise: float, jitter: float) -> tuple[Array, Array]:
    rng = np.random.default_rng(7)
    t = np.arange(0, SECONDS, 1 / rate)
    t = t + jitter / rate * rng.uniform(-1, 1, len(t))
    return t, MOTION(t)[0] + noise * rng.normal(size=len(t))


def relative_error(fitted: Array, t: Array) -> Array:
    """Of theta, rate, acceleration: rms error over rms."""
    true = MOTION(t)
    return np.sqrt(np.mean((fitted - true) ** 2, axis=1) / np.mean(true**2, axis=1))


def least_possible_error(t: Array, angle: Array, judged: Array) -> Array:
    """Of one who knows the truth and picks the number of knots by it, for theta, rate and acceleration each its own."""
    errors = []
    for intervals in np.geomspace(4, len(t) // 3, 40).astype(int):
        inner = np.linspace(t[0], t[-1], intervals + 1)[1:-1]
        knots = np.concatenate([np.full(6, t[0]), inner, np.full(6, t[-1])])
        spline = make_lsq_spline(t, angle, knots, k=5)
        errors.append(relative_error(np.stack([spline(judged, d) for d in range(3)]), judged))
    return np.min(errors, axis=0)


@pytest.mark.parametrize("jitter", [0.0, 0.3])
@pytest.mark.parametrize("rate", [50.0, 200.0, 1000.0])
def test_clean_samples_are_interpolated(rate: float, jitter: float) -> None:
    t, angle = sample(rate, 0.0, jitter)
    motion = fit_samples(t, angle)
    assert motion.noise == 0.0
    np.testing.assert_allclose(motion(t)[0], angle, atol=1e-13)  # rounding
    judged = np.linspace(0.5, SECONDS - 0.5, 1000)
    # A quintic's error is of order (omega h)^6, and h^4 for the second derivative: at 50 Hz and 2.2 Hz, 2e-4 at most.
    assert (relative_error(motion(judged), judged) < [1e-6, 1e-5, 2e-4]).all()


@pytest.mark.parametrize("jitter", [0.0, 0.3])
@pytest.mark.parametrize("noise", [1e-4, 5e-3])
@pytest.mark.parametrize("rate", [50.0, 200.0])
def test_noisy_samples_are_smoothed_near_the_optimum(rate: float, noise: float, jitter: float) -> None:
    t, angle = sample(rate, noise, jitter)
    motion = fit_base_motion(MotorSignal(t, angle, angle))
    assert motion.noise == pytest.approx(noise, rel=0.25)  # 400 samples less 90 coefficients: 4 %, GCV's choice 10 %
    judged = np.linspace(0.5, SECONDS - 0.5, 1000)
    error = relative_error(motion(judged), judged)
    # Cross-validation's choice scatters about the best one by some knots, which the second derivative feels the most.
    assert (error < least_possible_error(t, angle, judged) * [1.3, 1.6, 2.2]).all()
    # And against what differencing the samples would give, acceleration error sqrt(6) noise rate^2;
    # at 50 Hz a tenth of it, since the band holds a tenth of the samples' degrees of freedom:
    assert error[2] < 0.15 * np.sqrt(6) * noise * rate**2 / np.sqrt(np.mean(MOTION(judged)[2] ** 2))


def test_a_servo_potentiometer_of_twelve_bits() -> None:
    """Rounding to steps is noise of step / sqrt(12), and is found to be."""
    step = 2 * np.pi / 4096
    t = np.arange(0, 20, 0.02)
    motion = fit_samples(t, np.round(MOTION(t)[0] / step) * step)
    assert motion.noise == pytest.approx(step / np.sqrt(12), rel=0.1)  # 1000 samples: 2 %, and steps are no white noise


def test_derivatives_are_those_of_the_angle() -> None:
    chirp = Chirp(0.4, 0.3, 2.0, 8.0)
    t = np.arange(0, 8, 0.005)
    motion = fit_samples(t, chirp(t)[0] + np.random.default_rng(2).normal(0, 1e-3, len(t)))
    judged, h = np.linspace(0.1, 7.9, 200), 1e-4
    before, now, after = motion(judged - h), motion(judged), motion(judged + h)
    # Central differences of a quintic spline: h^2 times its third derivatives, about 1e-8 * 1e3.
    np.testing.assert_allclose((after[0] - before[0]) / (2 * h), now[1], atol=1e-4)
    np.testing.assert_allclose((after[1] - before[1]) / (2 * h), now[2], atol=1e-3)


def test_a_gap_in_the_samples_is_bridged() -> None:
    t, angle = sample(100.0, 1e-3, 0.0)
    kept = (t < 3.0) | (t > 3.15)
    motion = fit_samples(t[kept], angle[kept])
    gap = np.linspace(3.0, 3.15, 20)
    # The gap is a third of the fastest period: noise and the knots' spacing leave it within a few noise sigmas.
    np.testing.assert_allclose(motion(gap)[0], MOTION(gap)[0], atol=0.02)


def test_rest_stays_at_rest_and_six_samples_are_enough() -> None:
    rest = fit_samples(np.linspace(0, 1, 100), np.full(100, 0.3))
    np.testing.assert_allclose(rest(np.linspace(0, 1, 33)), np.array([[0.3], [0], [0]]) * np.ones(33), atol=1e-9)
    line = fit_samples(np.linspace(0, 1, 6), 2.0 * np.linspace(0, 1, 6))
    np.testing.assert_allclose(line(0.37), [0.74, 2.0, 0.0], atol=1e-11)
    with pytest.raises(InputError, match="5 samples"):
        fit_samples(np.linspace(0, 1, 5), np.zeros(5))


def test_outside_the_samples_the_base_comes_to_rest_and_far_outside_it_is_unknown() -> None:
    line = fit_samples(np.linspace(0, 1, 60), 2.0 * np.linspace(0, 1, 60))
    t, h = np.array([-0.9, -0.1, -0.01, 1.01, 1.1, 1.9]), 1e-5
    before, now, after = line(t - h), line(t), line(t + h)
    # Central differences of exponentials of 0.05 s: h^2 / 6 times 2 / 0.05^2 = 1e-8, and 3e-7 for the second.
    np.testing.assert_allclose((after[0] - before[0]) / (2 * h), now[1], atol=1e-7)
    np.testing.assert_allclose((after[1] - before[1]) / (2 * h), now[2], atol=1e-5)
    np.testing.assert_allclose(line(1.9), [2.1, 0.0, 0.0], atol=1e-5)  # exp(-18) of 40 rad/s^2
    with pytest.raises(InputError, match=r"asked for from 0 to 2\.2 s; expected times from 0 to 1 s"):
        line([0.0, 2.2])
