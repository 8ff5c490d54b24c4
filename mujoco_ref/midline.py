"""From link directions to the arm's smooth midline: the tangent angle is known at s = k/n, with a spline between."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from tentacle.errors import InputError
from tentacle.signals import Array

_FINE = 8  # Simpson intervals between two nodes: the quadrature error is far below the spline's


def chain_midline_points(angles: Array, mount: Array, length: float, s: Array) -> Array:
    """Points (F, P, 2) [m] of the midline in the base frame.

    angles (F, n + 1): tangent angle at s = k/n [rad]; mount (F, 2) [m]; s (P,) in [0, 1]. r(s) = L int (-sin phi, cos
    phi).
    """
    if np.any(s < 0.0) or np.any(s > 1.0):
        raise InputError("outside of the arm", field="s", expected="values in [0, 1]")
    links = angles.shape[1] - 1
    fine = np.linspace(0.0, 1.0, 2 * _FINE * links + 1)
    phi = CubicSpline(np.arange(links + 1) / links, angles, axis=1)(fine)
    tangent = np.stack([-np.sin(phi), np.cos(phi)], axis=-1)
    interval = fine[2] - fine[0]
    pieces = interval / 6.0 * (tangent[:, 0:-2:2] + 4.0 * tangent[:, 1:-1:2] + tangent[:, 2::2])
    whole = np.concatenate([np.zeros_like(pieces[:, :1]), np.cumsum(pieces, axis=1)], axis=1)
    # Hermite interpolation: positions and tangents are both known at the fine points.
    coarse = fine[::2]
    cell = np.clip(np.searchsorted(coarse, s, side="right") - 1, 0, coarse.size - 2)
    u = ((s - coarse[cell]) / interval)[:, None]
    left, right = whole[:, cell], whole[:, cell + 1]
    slope_left, slope_right = interval * tangent[:, 2 * cell], interval * tangent[:, 2 * cell + 2]
    h00, h10 = 2 * u**3 - 3 * u**2 + 1, u**3 - 2 * u**2 + u
    h01, h11 = -2 * u**3 + 3 * u**2, u**3 - u**2
    return length * (h00 * left + h10 * slope_left + h01 * right + h11 * slope_right) + mount[:, None, :]
