"""Base motions theta(t) with their first two derivatives: rest, sine, chirp, multisine, the nine-parameter gait (eq. 20)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from tentacle.signals import Array


class Waveform(Protocol):
    """A base motion: called with times (...) [s] it gives theta, its rate and its acceleration, (3, ...) in rad, s."""

    def __call__(self, t: ArrayLike) -> Array: ...


@dataclass(frozen=True)
class Rest:
    """The base stands still at angle [rad]."""

    angle: float = 0.0

    def __call__(self, t: ArrayLike) -> Array:
        t = np.asarray(t, dtype=float)
        return np.stack([np.full_like(t, self.angle), np.zeros_like(t), np.zeros_like(t)])


@dataclass(frozen=True)
class Sine:
    """amplitude [rad] sin(2 pi frequency t + phase), frequency [Hz], phase [rad]."""

    amplitude: float
    frequency: float
    phase: float = 0.0

    def __call__(self, t: ArrayLike) -> Array:
        omega = 2.0 * np.pi * self.frequency
        angle = omega * np.asarray(t, dtype=float) + self.phase
        wave = np.stack([np.sin(angle), omega * np.cos(angle), -(omega**2) * np.sin(angle)])
        return self.amplitude * wave


@dataclass(frozen=True)
class Chirp:
    """A sine whose frequency rises linearly from start to stop [Hz] over duration [s]; amplitude [rad]."""

    amplitude: float
    start: float
    stop: float
    duration: float

    def __call__(self, t: ArrayLike) -> Array:
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
        parts = zip(self.amplitudes, self.frequencies, self.phases, strict=True)
        return np.sum([Sine(amplitude, frequency, phase)(t) for amplitude, frequency, phase in parts], axis=0)
