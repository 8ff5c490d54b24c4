"""The motion of a midline: its velocity and the frame of its sections, from positions over time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tentacle.signals import Array


@dataclass(frozen=True)
class MidlineMotion:
    """A midline's motion in the base frame, NaN where unknown: velocity, normal, tangent (T, P, 2) [m/s, 1, 1],
    and angle (T, P) [rad] of the tangent, 0 along +y (n = (cos, sin), t = (-sin, cos)).
    """

    velocity: Array
    normal: Array
    tangent: Array
    angle: Array


def midline_motion(t: Array, s: Array, xy: Array) -> MidlineMotion:
    """The motion of a midline xy (T, P, 2) [m] at times t (T,) [s] and places s (P,), both rising.

    The velocity is that of the cubic spline through each point's positions: at 30 frames/s, 0.1 % off for a motion
    of 2 Hz. Instants with a missing point are NaN; so is everything where fewer than four are whole.
    """
    from scipy.interpolate import CubicSpline

    velocity, slope = np.full(xy.shape, np.nan), np.full(xy.shape, np.nan)
    whole = np.isfinite(xy).all(axis=(1, 2))
    if whole.sum() >= 4 and len(s) >= 4:
        velocity[whole] = CubicSpline(t[whole], xy[whole], axis=0)(t[whole], 1)
        slope[whole] = CubicSpline(s, xy[whole], axis=1)(s, 1)
    tangent = slope / np.linalg.norm(slope, axis=-1, keepdims=True)
    normal = np.stack([tangent[..., 1], -tangent[..., 0]], axis=-1)
    angle = np.unwrap(np.arctan2(-tangent[..., 0], tangent[..., 1]), axis=1)
    return MidlineMotion(velocity, normal, tangent, angle)
