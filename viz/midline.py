"""The shape that a track's coefficients describe, as points to draw."""

from __future__ import annotations

import numpy as np
from numpy.polynomial.legendre import leggauss

from tentacle.signals import Array, ShapeTrack
from tentacle.specimen import Section

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


def perimeter(xy: Array, s: Array, section: Section) -> Array:
    """Outline (..., 2 P, 2) [m] of the arm around its midline xy (..., P, 2) [m] at s (P,): down one side, up the
    other (4).
    """
    tangent = np.gradient(xy, axis=-2)
    tangent /= np.linalg.norm(tangent, axis=-1, keepdims=True)
    normal = np.stack([tangent[..., 1], -tangent[..., 0]], axis=-1)
    half = section.half_thickness(s)[:, None]
    return np.concatenate([xy + half * normal, (xy - half * normal)[..., ::-1, :]], axis=-2)


def affine_projection(order: int) -> Array:
    """Matrix (2, order): from q_1 .. q_order to the paper's (q1, q2) whose midline lies closest, for small bending.

    q_j bends the midline by s^(j+1) / (j (j+1)), so the Gram matrix is 1 / (i (i+1) j (j+1) (i+j+3)). The raw
    first two of more coordinates are nearly collinear and say little. A curvature of 1 - 6 s + 6 s^2 reads (.46, -1.5).
    """
    j = np.arange(1.0, max(order, 2) + 1)
    gram = 1.0 / (np.outer(j * (j + 1), j * (j + 1)) * (j[:, None] + j + 3))
    return np.asarray(np.linalg.solve(gram[:2, :2], gram[:2, :])[:, :order], dtype=np.float64)


def paper_coordinates(shape: ShapeTrack) -> tuple[Array, Array]:
    """The paper's q1, q2 (T, 2) [rad] of a track and their standard deviations (T, 2) [rad]; NaN where rejected."""
    projection = affine_projection(shape.coefficients.shape[1] - 1)
    covariance = np.einsum("ij,tjk,ik->ti", projection, shape.covariance[:, 1:, 1:], projection)
    q, sigma = shape.coefficients[:, 1:] @ projection.T, np.sqrt(covariance)
    q[~shape.accepted], sigma[~shape.accepted] = np.nan, np.nan
    return q, sigma
