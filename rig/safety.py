"""Limits of the arm and the servo. They have no defaults. They are checked here before a run, and again on
the board.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rig import command_bodies, protocol
from tentacle.errors import InputError
from tentacle.signals import Array
from tentacle.waveform import Waveform

WATCHDOG = 0.25  # s of silence after which the board leaves the run (core/board.hpp)
SERVO_FRAME = 0.02  # s; 50 Hz
NEUTRAL_WITHIN = 0.5  # s from the host's death to the arm at neutral


@dataclass(frozen=True)
class SafetyLimits:
    """Limits of the servo: angles [rad] around neutral (0), speed [rad/s], current [A], all positive but
    min_angle.
    """

    min_angle: float
    max_angle: float
    max_speed: float
    max_current: float

    def __post_init__(self) -> None:
        values = (self.min_angle, self.max_angle, self.max_speed, self.max_current)
        if not all(np.isfinite(values)):
            raise InputError(f"{values!r} are not usable", field="limits", expected="finite numbers")
        if not self.min_angle < 0 < self.max_angle:
            raise InputError(
                f"{self.min_angle:g} to {self.max_angle:g} rad leaves out neutral",
                field="limits.min_angle_rad",
                expected="min_angle_rad < 0 < max_angle_rad",
            )
        for name, value in (("max_speed_rad_s", self.max_speed), ("max_current_a", self.max_current)):
            if value <= 0:
                raise InputError(f"{value!r} is not usable", field=f"limits.{name}", expected="a positive number")
        if self.neutral_time > NEUTRAL_WITHIN:
            least = max(self.max_angle, -self.min_angle) / (NEUTRAL_WITHIN - WATCHDOG - 2 * SERVO_FRAME)
            raise InputError(
                f"at {self.max_speed:g} rad/s a silent host leaves the arm deflected for {self.neutral_time:.2f} s",
                field="limits.max_speed_rad_s",
                expected=f">= {least:.3g} (neutral within {NEUTRAL_WITHIN} s), or smaller angles",
            )

    @property
    def neutral_time(self) -> float:
        """From the host's silence to neutral, at worst [s]: the watchdog, the way back, and two servo frames."""
        return WATCHDOG + max(self.max_angle, -self.min_angle) / self.max_speed + 2 * SERVO_FRAME


@dataclass(frozen=True)
class ServoCalibration:
    """Pulse [us] at angle 0 and its slope [us/rad]; negative where the servo turns the other way."""

    centre_us: float = 1500.0
    us_per_rad: float = 2000.0 / np.pi


def limits_message(limits: SafetyLimits, servo: ServoCalibration) -> bytes:
    """The limits as the board takes them (LIMITS)."""
    return command_bodies.limits(
        round(1e6 * limits.min_angle),
        round(1e6 * limits.max_angle),
        round(1e6 * limits.max_speed),
        round(1e3 * limits.max_current),
        round(servo.centre_us),
        round(servo.us_per_rad),
    )


def check_limits(limits: SafetyLimits, servo: ServoCalibration, boot: protocol.Boot) -> None:
    """InputError where the board, as it was built, cannot do what the limits permit."""
    for angle in (limits.min_angle, limits.max_angle):
        pulse = servo.centre_us + servo.us_per_rad * angle
        if not boot.pulse_min_us <= pulse <= boot.pulse_max_us:
            raise InputError(
                f"{angle:g} rad is a pulse of {pulse:.0f} us",
                field="limits",
                expected=f"pulses within {boot.pulse_min_us} to {boot.pulse_max_us} us, the board's own limit",
            )
    if 1e6 * limits.max_speed > boot.speed_urad_s:
        raise InputError(
            f"{limits.max_speed:g} rad/s is not permitted by the board",
            field="limits.max_speed_rad_s",
            expected=f"at most {1e-6 * boot.speed_urad_s:g}",
        )


def set_points(waveform: Waveform, duration: float, limits: SafetyLimits, period: float = SERVO_FRAME) -> Array:
    """Set points (N,) [rad], one every `period` [s] over `duration` [s], from neutral and back to it.

    A waveform that does not begin or end at neutral gets a smooth lead of half a second there; time 0 of the waveform
    is then lead_samples(...) periods after the first set point. InputError where an angle or speed is beyond the
    limits.
    """
    count = round(duration / period) + 1
    if count < 2:
        raise InputError(f"{duration!r} s is too short a run", field="duration", expected=f"more than {period} s")
    angle = np.asarray(waveform(np.arange(count) * period)[0], dtype=float)
    lead = lead_samples(waveform, period)
    rise = 0.5 - 0.5 * np.cos(np.pi * np.arange(lead) / max(lead, 1))
    tail = round(0.5 / period) if abs(angle[-1]) > 1e-3 else 0
    fall = 0.5 + 0.5 * np.cos(np.pi * np.arange(1, tail + 1) / max(tail, 1))
    points = np.concatenate([angle[0] * rise, angle, angle[-1] * fall])
    check_set_points(points, period, limits)
    return points


def lead_samples(waveform: Waveform, period: float = SERVO_FRAME) -> int:
    """How many set points lead from neutral to where the waveform begins."""
    return round(0.5 / period) if abs(float(waveform(0.0)[0])) > 1e-3 else 0


def check_set_points(points: Array, period: float, limits: SafetyLimits) -> None:
    """InputError at the first set point (N,) [rad] that is beyond an angle or cannot be reached at the speed limit."""
    if not np.all(np.isfinite(points)):
        k = int(np.argmin(np.isfinite(points)))
        raise InputError(f"not a number at {k * period:.3f} s", field="waveform", expected="finite angles")
    outside = (points < limits.min_angle) | (points > limits.max_angle)
    if outside.any():
        k = int(np.argmax(outside))
        raise InputError(
            f"{points[k]:.3f} rad at {k * period:.3f} s is beyond the limits",
            field="waveform",
            expected=f"angles within {limits.min_angle:g} to {limits.max_angle:g} rad",
        )
    speed = np.abs(np.diff(points, prepend=0.0)) / period
    if speed.max() > limits.max_speed * (1 + 1e-9):
        k = int(np.argmax(speed))
        raise InputError(
            f"{speed[k]:.2f} rad/s at {k * period:.3f} s is beyond the limit",
            field="waveform",
            expected=f"at most {limits.max_speed:g} rad/s",
        )
