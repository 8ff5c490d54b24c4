"""A motion of the base for the rig: set points within the limits, and the index at which the waveform begins."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from rig.safety import SERVO_FRAME, SafetyLimits, lead_samples, set_points
from tentacle.io.waveform_file import waveform_table
from tentacle.signals import Array
from tentacle.waveform import Waveform


@dataclass(frozen=True)
class RigMotion:
    """The planned motion: set points (N,) [rad] every `period` [s]; zero_index, the waveform's time 0; description,
    plain data for the start record.
    """

    points: Array
    period: float
    zero_index: int
    description: dict[str, Any]

    @property
    def duration(self) -> float:
        """From the first set point to the last [s]."""
        return (len(self.points) - 1) * self.period

    @property
    def lead(self) -> float:
        """From the first set point to the waveform's time 0 [s]."""
        return self.zero_index * self.period


def rig_motion(waveform: Waveform, duration: float, limits: SafetyLimits, description: dict[str, Any]) -> RigMotion:
    """A waveform as set points within the limits; InputError where it is beyond them."""
    points = set_points(waveform, duration, limits)
    return RigMotion(points, SERVO_FRAME, lead_samples(waveform), description)


def described(waveform: Waveform) -> dict[str, Any]:
    """A waveform as plain data, for the start record."""
    try:
        return waveform_table(waveform)
    except TypeError:  # a spline through samples has no table; the set points are in the recording
        return {"kind": "samples"}
