"""Base motions theta(t) with their first two derivatives: rest, sine, chirp, multisine, the gait of eq. 20, a ramp."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tentacle.signals import Array

GAIT_TERMS = 5


class Waveform(Protocol):
    """A base motion: called with times (...) [s] it gives theta, its rate and its acceleration, (3, ...) in rad, s."""

    def __call__(self, t: ArrayLike) -> Array:
        """Theta [rad], its rate [rad/s] and acceleration [rad/s^2] at times t (...) [s], stacked as (3, ...)."""
        ...


@dataclass(frozen=True)
class Rest:
    """The base stands still at angle [rad]."""

    angle: float = 0.0

    def __call__(self, t: ArrayLike) -> Array:
        """See Waveform."""
        t = np.asarray(t, dtype=float)
        return np.stack([np.full_like(t, self.angle), np.zeros_like(t), np.zeros_like(t)])


@dataclass(frozen=True)
class Sine:
    """amplitude [rad] sin(2 pi frequency t + phase), frequency [Hz], phase [rad]."""

    amplitude: float
    frequency: float
    phase: float = 0.0

    def __call__(self, t: ArrayLike) -> Array:
        """See Waveform."""
        return _sine(self.amplitude, 2.0 * np.pi * self.frequency, self.phase, np.asarray(t, dtype=float))


@dataclass(frozen=True)
class Chirp:
    """A sine whose frequency rises linearly from start to stop [Hz] over duration [s]; amplitude [rad]."""

    amplitude: float
    start: float
    stop: float
    duration: float

    def __call__(self, t: ArrayLike) -> Array:
        """See Waveform. Beyond the duration the frequency goes on rising."""
        t = np.asarray(t, dtype=float)
        rate = 2.0 * np.pi * (self.stop - self.start) / self.duration
        omega = 2.0 * np.pi * self.start + rate * t
        angle = 2.0 * np.pi * self.start * t + 0.5 * rate * t**2
        first = omega * np.cos(angle)
        second = rate * np.cos(angle) - omega**2 * np.sin(angle)
        return self.amplitude * np.stack([np.sin(angle), first, second])


@dataclass(frozen=True)
class Multisine:
    """A sum of sines: amplitudes [rad], frequencies [Hz] and phases [rad], one each per component."""

    amplitudes: tuple[float, ...]
    frequencies: tuple[float, ...]
    phases: tuple[float, ...]

    def __call__(self, t: ArrayLike) -> Array:
        """See Waveform. ValueError where the three tuples differ in length."""
        parts = zip(self.amplitudes, self.frequencies, self.phases, strict=True)
        return np.sum([Sine(amplitude, frequency, phase)(t) for amplitude, frequency, phase in parts], axis=0)


def gait_harmonics(terms: int) -> tuple[NDArray[np.int_], Array, NDArray[np.int_]]:
    """The harmonics (H,) of eq. 20: multiple of fundamental, coefficient, wave (0 sine, 1 square, 2 saw-tooth)."""
    square, saw = 2 * np.arange(1, terms + 1) - 1, np.arange(1, terms + 1)
    multiple = np.concatenate([[1], square, saw])
    wave = np.repeat([0, 1, 2], [1, terms, terms])
    return multiple, 1.0 / multiple, wave


def band_weight(multiple: ArrayLike, omega: ArrayLike, bandwidth: float) -> Array:
    """What of harmonic n (...) of a fundamental omega (...) [rad/s] stays: for n >= 2 cos^2(pi/2 n f / bandwidth)."""
    multiple = np.asarray(multiple)
    share = multiple * np.abs(omega) / (2.0 * np.pi * bandwidth)
    return np.where(multiple == 1, 1.0, np.cos(0.5 * np.pi * np.minimum(share, 1.0)) ** 2)


@dataclass(frozen=True)
class Gait:
    """The nine-parameter gait of eq. 20: a sine, a square wave and a saw-tooth, each with amplitude, rate and phase.

    alpha: (alpha_1 .. alpha_9); 1-3 amplitudes [rad], 4-6 angular rates [rad/s], 7-9 phases [rad], in that order of
    waves. The print sums infinitely many terms, whose acceleration has no limit (the n-th term's grows like n): here
    the first `terms` of each are taken, and they fade out towards the servo's bandwidth [Hz] where one is given
    (band_weight). As printed, a phase is added to every harmonic alike, so that alpha_8 and alpha_9 bend the square
    and the saw-tooth rather than shift them.
    """

    alpha: tuple[float, float, float, float, float, float, float, float, float]
    terms: int = GAIT_TERMS
    bandwidth: float = np.inf

    def __call__(self, t: ArrayLike) -> Array:
        """See Waveform."""
        t = np.asarray(t, dtype=float)
        amplitude, omega, phase = np.array(self.alpha).reshape(3, 3)
        motion = np.zeros((3, *t.shape))
        for multiple, coefficient, wave in zip(*gait_harmonics(self.terms), strict=True):
            strength = amplitude[wave] * coefficient * band_weight(multiple, omega[wave], self.bandwidth)
            motion += _sine(float(strength), float(multiple * omega[wave]), float(phase[wave]), t)
        return motion


@dataclass(frozen=True)
class Ramped:
    """A waveform that starts from rest at theta = 0: multiplied by 10 x^3 - 15 x^4 + 6 x^5, x = t / duration [s].

    The factor has two continuous derivatives, 0 before t = 0 and 1 after the duration; so theta, its rate and its
    acceleration start at 0 and the arm is not kicked.
    """

    waveform: Waveform
    duration: float

    def __call__(self, t: ArrayLike) -> Array:
        """See Waveform."""
        t = np.asarray(t, dtype=float)
        theta, rate, acceleration = self.waveform(t)
        x = np.clip(t / self.duration, 0.0, 1.0)
        ramp = x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
        first = 30.0 * x**2 * (1.0 - x) ** 2 / self.duration
        second = 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / self.duration**2
        return np.stack(
            [
                ramp * theta,
                ramp * rate + first * theta,
                ramp * acceleration + 2.0 * first * rate + second * theta,
            ]
        )


def _sine(amplitude: float, omega: float, phase: float, t: Array) -> Array:
    angle = omega * t + phase
    return amplitude * np.stack([np.sin(angle), omega * np.cos(angle), -(omega**2) * np.sin(angle)])
