"""The servo's limits, which every gait keeps, and the box of eq. 21 in which gaits are searched."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from affine_model.curvature import Array
from affine_model.swim.evaluate import Bounds
from tentacle.errors import InputError
from tentacle.servo_limits import ServoLimits

# A waterproof hobby servo of the paper's class turns 60 degrees in 0.16 s without load and holds about 1 N m: with a
# margin.
HOBBY_SERVO = ServoLimits(angle=np.pi / 3.0, speed=6.0, acceleration=120.0)


@dataclass(frozen=True)
class GaitLimits:
    """servo: largest angle, speed, acceleration; torque [N m] at the horn; bandwidth [Hz] of what the servo follows.

    lowest_frequency, highest_frequency [Hz] bound the fundamentals that are searched. Raises InputError where they
    cross.
    """

    servo: ServoLimits = HOBBY_SERVO
    torque: float = 1.0
    bandwidth: float = 5.0
    highest_frequency: float = 2.5
    lowest_frequency: float = 0.25

    def __post_init__(self) -> None:
        for name in ("torque", "bandwidth", "highest_frequency", "lowest_frequency"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(f"{value!r} is infeasible", field=f"limits.{name}", expected="a positive number")
        if not self.lowest_frequency < self.highest_frequency <= self.bandwidth:
            raise InputError(
                f"bounds cross: lowest {self.lowest_frequency:g}, highest {self.highest_frequency:g}, bandwidth "
                f"{self.bandwidth:g} Hz",
                field="limits",
                expected="lowest_frequency < highest_frequency <= bandwidth",
            )

    @property
    def bounds(self) -> Bounds:
        """What a batch of gaits is scaled to."""
        servo = self.servo
        return Bounds(np.array([servo.angle, servo.speed, servo.acceleration]), self.bandwidth)


@dataclass(frozen=True)
class Box:
    """l_bound and u_bound of eq. 21: lower (9,), upper (9,) of alpha. Raises InputError where they cross."""

    lower: tuple[float, ...]
    upper: tuple[float, ...]

    def __post_init__(self) -> None:
        for index, (low, high) in enumerate(zip(self.lower, self.upper, strict=True)):
            if not (np.isfinite(low) and np.isfinite(high) and low < high):
                raise InputError(
                    f"bounds {low:g} and {high:g} cross", field=f"alpha_{index + 1}", expected="lower < upper"
                )

    def alpha(self, unit: Array) -> Array:
        """Gaits (9, B) of points (9, B) of the unit cube; phases are periodic, so theirs may lie outside [0, 1]."""
        low, high = np.array(self.lower)[:, None], np.array(self.upper)[:, None]
        return low + (high - low) * np.concatenate([np.clip(unit[:6], 0.0, 1.0), unit[6:] % 1.0])

    def unit(self, alpha: Array) -> Array:
        """The inverse of alpha()."""
        low, high = np.array(self.lower)[:, None], np.array(self.upper)[:, None]
        return (alpha - low) / (high - low)


def search_box(limits: GaitLimits) -> Box:
    """Amplitudes of either sign up to the servo's angle, its frequencies, all phases.

    A square wave's fundamental is 4/pi of its level, a saw-tooth's 2/pi: the same amplitude bound serves all three
    terms. Amplitudes need no negative sign: a phase of pi does the same.
    """
    low, high = 2.0 * np.pi * limits.lowest_frequency, 2.0 * np.pi * limits.highest_frequency
    return Box((0.0,) * 3 + (low,) * 3 + (0.0,) * 3, (limits.servo.angle,) * 3 + (high,) * 3 + (2.0 * np.pi,) * 3)
