"""Limits of a servo: angle, speed and acceleration, and the check of a base motion against them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tentacle.errors import InputError
from tentacle.waveform import Waveform

SAMPLES_PER_SECOND = 1000  # motions are under 20 Hz: a peak between samples is missed by less than 0.1 %


@dataclass(frozen=True)
class ServoLimits:
    """Largest |theta| [rad], |rate| [rad/s] and |acceleration| [rad/s^2] of the base; none of them has a default."""

    angle: float
    speed: float
    acceleration: float

    def __post_init__(self) -> None:
        """InputError where a limit is not a positive number."""
        for name in ("angle", "speed", "acceleration"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise InputError(f"{value!r} is not usable", field=f"servo limit: {name}", expected="a positive number")

    def peaks(self, waveform: Waveform, duration: float) -> tuple[float, float, float]:
        """The largest |theta|, |rate| and |acceleration| of a motion over [0, duration] [s]."""
        t = np.linspace(0.0, duration, max(2, int(np.ceil(duration * SAMPLES_PER_SECOND)) + 1))
        angle, speed, acceleration = np.abs(waveform(t)).max(axis=1).tolist()
        return angle, speed, acceleration

    def check(self, waveform: Waveform, duration: float) -> None:
        """InputError naming the first limit that the motion exceeds within [0, duration] [s]."""
        limits = (self.angle, self.speed, self.acceleration)
        units = ("rad", "rad/s", "rad/s^2")
        for name, peak, limit, unit in zip(
            ("angle", "speed", "acceleration"), self.peaks(waveform, duration), limits, units, strict=True
        ):
            if peak > limit:
                raise InputError(
                    f"the motion reaches {peak:.4g} {unit}", field=f"waveform {name}", expected=f"<= {limit:g} {unit}"
                )
