"""The servo between command and clamp: a lag of first or second order, a play with a rigid or an elastic coupling."""

from __future__ import annotations

import numpy as np

from tentacle.compiled import njit
from tentacle.signals import Array

DAMPED = 0.7  # of critical, a servo's loop of second order
# A worn coupling has play and gives: the clamp's natural frequency [rad/s] on it at a play of WORN rad, and its damping
# as a share of the critical one. The compliance is proportional to the play. A coupling without play is rigid.
SPRING, RATIO, WORN = 60.0, 0.35, 0.03
RESOLVED = 0.3  # rad of the coupling's vibration a step, at most: a stiffer one follows like a rigid one


def turned(command: Array, step: float, numbers: dict[str, float], laws: dict[str, str]) -> Array:
    """Angle of the clamp [rad] for a command sampled every step [s], under servo_lag and backlash."""
    angle = command
    if "servo_lag" in laws:
        angle = _late(angle, step, numbers["lag"], laws["servo_lag"] == "second_order")
    if "backlash" in laws:
        angle = _play(angle, step, numbers["play"], laws["backlash"] == "sprung")
    return angle


@njit(cache=True)
def _late(command: Array, step: float, lag: float, second: bool) -> Array:
    """First order of time constant `lag`, or second order of the same delay 2 zeta / omega; by the midpoint rule."""
    out = np.empty_like(command)
    angle, rate = command[0], 0.0
    omega = 2.0 * DAMPED / lag
    for k in range(command.size):
        if second:
            rate += step * (omega * omega * (command[k] - angle) - 2.0 * DAMPED * omega * rate)
            angle += step * rate
        else:
            angle += (command[k] - angle) * (1.0 - np.exp(-step / lag))
        out[k] = angle
    return out


@njit(cache=True)
def _play(command: Array, step: float, play: float, sprung: bool) -> Array:
    """The clamp is free within the play. Beyond it the horn moves the clamp, rigidly or by a spring."""
    out = np.empty_like(command)
    angle, rate = command[0], 0.0
    omega = min(SPRING * np.sqrt(WORN / max(play, 1e-12)), RESOLVED / step)
    for k in range(command.size):
        beyond = command[k] - angle
        beyond -= min(max(beyond, -0.5 * play), 0.5 * play)
        if not sprung:
            angle += beyond
        else:
            # Within the play the seal's friction brakes the clamp; beyond it the elastic coupling vibrates.
            brake = 2.0 * RATIO * omega * rate if beyond != 0.0 else 0.5 * omega * rate
            rate += step * (omega * omega * beyond - brake)
            angle += step * rate
        out[k] = angle
    return out
