"""Base motions theta(t) with their first two derivatives: rest, sine, chirp, multisine, a ramp.

The gait of eq. 20 is in tentacle.gait, motions fitted to samples in tentacle.base_motion, files in waveform_file.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from tentacle.signals import Array


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


@dataclass(frozen=True)
class Ramped:
    """A waveform that starts from rest at theta = 0: multiplied by 10 x^3 - 15 x^4 + 6 x^5, x = t / duration [s].

    The factor has two continuous derivatives, 0 before t = 0 and 1 after the duration; so theta, its rate and its
    acceleration start at 0, without a jump.
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
