"""The space of periodic gaits on the rig: every point is within the servo's limits by construction."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rig.safety import SafetyLimits
from tentacle.errors import InputError
from tentacle.waveform import Multisine

LIMIT_SHARE = 0.98  # of the limits: set points are linear between samples, and start from neutral
_PHASES = np.linspace(0.0, 2.0 * np.pi, 256, endpoint=False)


@dataclass(frozen=True)
class GaitSpace:
    """Gaits theta(t) = A w(2 pi f t), w a sine with odd harmonics (they keep the stroke symmetric).

    frequency (low, high) [Hz]; harmonics: how many odd harmonics beyond the first (0: plain sines). A point is a dict:
    frequency_hz, effort (the share of the largest amplitude that the limits permit at that frequency and shape,
    least_effort..1), and share_n (-0.6..0.6, relative to the fundamental) and phase_n (0..2 pi) for n = 3, 5, ...
    """

    limits: SafetyLimits
    frequency: tuple[float, float]
    harmonics: int = 1
    least_effort: float = 0.2

    def __post_init__(self) -> None:
        low, high = self.frequency
        if not 0 < low < high <= 10:
            raise InputError(
                f"{low:g} to {high:g} Hz", field="frequency_hz", expected="0 < low < high <= 10 (50 Hz servo)"
            )
        if not 0 <= self.harmonics <= 3:
            raise InputError(f"{self.harmonics!r} is not usable", field="harmonics", expected="0 to 3")

    @property
    def bounds(self) -> dict[str, tuple[float, float]]:
        """Every coordinate with its bounds."""
        bounds = {"frequency_hz": self.frequency, "effort": (self.least_effort, 1.0)}
        for order in self._orders:
            bounds[f"share_{order}"] = (-0.6, 0.6)
            bounds[f"phase_{order}"] = (0.0, 2.0 * np.pi)
        return bounds

    @property
    def _orders(self) -> tuple[int, ...]:
        return tuple(3 + 2 * k for k in range(self.harmonics))

    def gait(self, point: Mapping[str, float]) -> Multisine:
        """The gait of a point; InputError where a coordinate is missing or out of bounds."""
        for name, (low, high) in self.bounds.items():
            if name not in point or not low - 1e-9 <= point[name] <= high + 1e-9:
                raise InputError(f"{point.get(name)!r}", field=name, expected=f"{low:g} to {high:g}")
        frequency = point["frequency_hz"]
        shares = (1.0, *(point[f"share_{n}"] for n in self._orders))
        phases = (0.0, *(point[f"phase_{n}"] for n in self._orders))
        orders = (1, *self._orders)
        angle = sum(a * np.sin(n * _PHASES + p) for a, n, p in zip(shares, orders, phases, strict=True))
        speed = sum(a * n * np.cos(n * _PHASES + p) for a, n, p in zip(shares, orders, phases, strict=True))
        reach = min(self.limits.max_angle, -self.limits.min_angle) / np.abs(angle).max()
        pace = self.limits.max_speed / (2.0 * np.pi * frequency * np.abs(speed).max())
        amplitude = LIMIT_SHARE * point["effort"] * float(min(reach, pace))
        return Multisine(tuple(amplitude * share for share in shares), tuple(frequency * n for n in orders), phases)

    def sample(self, count: int, seed: int) -> list[dict[str, float]]:
        """Points spread evenly over the space (a scrambled Sobol sequence)."""
        from scipy.stats import qmc

        names, bounds = list(self.bounds), np.array(list(self.bounds.values()))
        unit = qmc.Sobol(len(names), rng=seed).random_base2(int(np.ceil(np.log2(max(count, 2)))))[:count]
        return [dict(zip(names, row, strict=True)) for row in (bounds[:, 0] + unit * np.ptp(bounds, axis=1)).tolist()]


@dataclass(frozen=True)
class TrialPlan:
    """The test of one gait: number of periods, of which the first `transient` are not counted."""

    periods: int = 6
    transient: int = 2

    def duration(self, frequency: float) -> float:
        """Length of a trial [s]."""
        return self.periods / frequency

    def window(self, frequency: float) -> tuple[float, float]:
        """The whole periods over which thrust is averaged [s]."""
        return self.transient / frequency, self.periods / frequency
