"""Points beside the axis, such as markers on the arm's skin: the paper's x(s, d).

    x(s, d) = L int_0^s (-sin phi, cos phi) dv + d (cos phi, sin phi),   phi(s) = theta + sum_j q_j s^j / j   (eq. 1-4)

A fit to markers asks for hundreds of millions of these shapes. The loops are compiled, over many shapes at once.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from affine_model.curvature import Array, integration_to, quadrature
from affine_model.sincos import sincos
from tentacle.compiled import njit

NODES = 16  # as in `affine_model.curvature.midline`: 1e-9 L for |alpha| up to pi
CHUNK = 256  # shapes at once: what stays in the nearest cache
_sincos = njit(inline="always")(sincos)


def points_beside(
    q: ArrayLike, theta: ArrayLike, length: float, s: ArrayLike, d: ArrayLike, shear: Array | None = None
) -> Array:
    """Positions of points (s, d) in the base frame, the base turned by theta: d (P,) [m] along the section's normal.

    q (..., n) [rad], theta (...) [rad], s (P,): shape (..., P, 2) [m]. shear (n + 1, n): by how much sections stand
    askew (affine_model.shear.Shear.gamma; None: square to the axis).
    """
    q, s = np.asarray(q, dtype=float), np.asarray(s, dtype=float)
    shapes, order = q.reshape(-1, q.shape[-1]), np.arange(1, q.shape[-1] + 1)
    angle = np.broadcast_to(np.asarray(theta, dtype=float), q.shape[:-1]).ravel()
    along = np.concatenate([quadrature(NODES).s, s])[:, None] ** order / order
    if shear is not None:  # of the points alone, not of the axis: phi - gamma
        askew = np.vander(s, len(shear), increasing=True)
        along = np.concatenate([along, np.pad(-askew, ((along.shape[0] - s.size, 0), (0, 0)))], axis=1)
        shapes = np.concatenate([shapes, shapes @ shear.T], axis=1)
    weights = np.concatenate([length * integration_to(NODES, s).T, np.diag(np.asarray(d, dtype=float))])
    found = _points(np.ascontiguousarray(shapes.T), angle, along, weights)
    return np.asarray(found.T.reshape(*q.shape[:-1], s.size, 2))


@njit(cache=True, nogil=True)
def _points(q, theta, along, weights):
    """x and y of each point in turn (2 P, N), for shapes q (n, N)."""
    order, shapes = q.shape
    places, points = weights.shape
    nodes = places - points
    found = np.zeros((2 * points, shapes))
    phi, sine, cosine = np.empty(CHUNK), np.empty(CHUNK), np.empty(CHUNK)
    for first in range(0, shapes, CHUNK):
        last = min(first + CHUNK, shapes)
        base = theta[first:last]
        for i in range(places):
            for e in range(base.size):
                phi[e] = base[e]
            for j in range(order):
                share, coordinate = along[i, j], q[j, first:last]
                for e in range(base.size):
                    phi[e] += share * coordinate[e]
            for e in range(base.size):
                sine[e], cosine[e] = _sincos(phi[e])
            for p in range(points):
                x, y, weight = found[2 * p, first:last], found[2 * p + 1, first:last], weights[i, p]
                if i < nodes:  # the axis: along the tangent (-sin, cos)
                    for e in range(base.size):
                        x[e] -= weight * sine[e]
                        y[e] += weight * cosine[e]
                elif weight != 0.0:  # beside it: along the normal (cos, sin)
                    for e in range(base.size):
                        x[e] += weight * cosine[e]
                        y[e] += weight * sine[e]
    return found
