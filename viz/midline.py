"""The shape that a track's coefficients describe, as points to draw."""

from __future__ import annotations

import numpy as np
from numpy.polynomial.legendre import leggauss

from tentacle.signals import Array, ShapeTrack

DRAWN_POINTS = 41


def midline_points(angle: Array, curvature: Array, length: float, s: Array) -> Array:
    """Midline (T, P, 2) [m] in the base frame at s (P,), of phi(s) = angle + sum_j curvature_j s^j / j.

    angle (T,) [rad] at the clamp, curvature (T, J) the paper's q_j [rad]; r(s) = L int_0^s (-sin phi, cos phi) dv
    (eq. 1-5), by Gauss-Legendre quadrature on [0, s] with 12 nodes (1e-9 L for shapes that turn by less than pi).
    """
    nodes, weights = leggauss(12)
    v = 0.5 * (nodes + 1.0) * np.asarray(s)[:, None]  # (P, 12)
    powers = np.stack([v**j / j for j in range(1, curvature.shape[1] + 1)])
    phi = angle[:, None, None] + np.tensordot(curvature, powers, axes=1)
    half = 0.5 * length * np.asarray(s)
    return np.stack([-(np.sin(phi) @ weights) * half, (np.cos(phi) @ weights) * half], axis=-1)


def track_points(shape: ShapeTrack, theta: Array, length: float, s: Array) -> Array:
    """Midline (T, P, 2) [m] of a track with the servo at theta (T,) [rad]; NaN where a frame was rejected."""
    angle = theta + shape.coefficients[:, 0]
    points = midline_points(angle, shape.coefficients[:, 1:], length * shape.scale, s)
    return points + shape.base_shift
