"""Where and when a frame shows the arm: what camera and clock make of it.

    a frame stamped t shows  (1 + excess) R(roll) x(t + offset + drift t) + shift

R: rotation by the camera's roll about the clamp. Every measurement effect changes a Sight by itself (`Effect.sight`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from tentacle.signals import Array


@dataclass(frozen=True)
class Sight:
    """roll [rad], excess of the scale, shift (x, y) of the clamp [arm lengths], offset [s] and drift of the clock.

    Numbers, or arrays (B,) of individuals. The default shows the arm as it is declared.
    """

    roll: Any = 0.0
    excess: Any = 0.0
    shift: tuple[Any, Any] = (0.0, 0.0)
    offset: Any = 0.0
    drift: Any = 0.0

    def shown_times(self, t: Array) -> Array:
        """The motor's times [s] at which frames stamped t [s] show the arm."""
        return t + self.offset + self.drift * t

    def seen_times(self, t: Array) -> Array:
        """The stamps [s] of frames that show the arm at the motor's times t [s]."""
        return (t - self.offset) / (1.0 + self.drift)
