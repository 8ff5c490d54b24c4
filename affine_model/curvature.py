"""Kinematics of polynomial curvature, any order (eq. 1-3): coordinates, quadrature, positions.

Outside, coordinates are the paper's q: c(s) = q1 + q2 s + q3 s^2 + ..., alpha(s) = sum_j q_j s^j / j. Inside, the
dynamics use shifted Legendre coordinates z, c(s) = sum_j z_j P_(j-1)(2 s - 1): the same space, but well conditioned
(the monomials' Gram matrix at order 5 has condition 5e5, Legendre's 9).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import Legendre, Polynomial
from numpy.polynomial.legendre import legvander
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@lru_cache(maxsize=16)
def legendre_to_monomial(order: int) -> Array:
    """Matrix T (order, order) with q = T z; kept, and not to be written to."""
    columns = np.zeros((order, order))
    for j in range(order):
        polynomial = Legendre.basis(j, domain=[0.0, 1.0]).convert(kind=Polynomial, domain=[-1.0, 1.0])
        columns[: j + 1, j] = polynomial.coef[: j + 1]
    columns.setflags(write=False)
    return columns


def curvature_basis(order: int, s: ArrayLike) -> Array:
    """dc/dz at s (P,): shape (P, order)."""
    return np.asarray(legvander(2.0 * np.asarray(s, dtype=float) - 1.0, order - 1), dtype=np.float64)


def angle_basis(order: int, s: ArrayLike) -> Array:
    """d alpha/dz at s (P,), the integral of the curvature basis from 0 (eq. 2): shape (P, order).

    int_0^s P_j(2 v - 1) dv = (P_(j+1) - P_(j-1)) / (4 j + 2) at 2 s - 1, and s for j = 0 (Abramowitz and Stegun 8.5.5).
    """
    s = np.asarray(s, dtype=float)
    values = legvander(2.0 * s - 1.0, order)
    j = np.arange(1, order)
    return np.concatenate([s[..., None], (values[..., 2:] - values[..., : order - 1]) / (4 * j + 2)], axis=-1)


@dataclass(frozen=True)
class Quadrature:
    """Gauss-Legendre on [0, 1]: nodes s (N,), weights (N,), and the matrix W (N, N) that integrates from 0 to each
    node.

    (W f)_i = int_0^(s_i) f ds, exact for polynomials of degree < N (the interpolant's integral).
    """

    s: Array
    weights: Array
    integration: Array


@lru_cache(maxsize=16)
def quadrature(count: int) -> Quadrature:
    """The rule with `count` nodes."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    s = 0.5 * (nodes + 1.0)
    values = curvature_basis(count, s)
    integrals = angle_basis(count, s)
    return Quadrature(s, 0.5 * weights, integrals @ np.linalg.inv(values))


def with_node_at_base(rule: Quadrature) -> Quadrature:
    """The rule with a node at s = 0 before all others: it adds nothing to any integral."""
    return Quadrature(np.append(0.0, rule.s), np.append(0.0, rule.weights), np.pad(rule.integration, ((1, 0), (1, 0))))


def integration_to(count: int, points: ArrayLike) -> Array:
    """Matrix (P, N) that integrates values at the rule's `count` nodes from 0 to each of the points (P,)."""
    return _integration_to(count, tuple(np.asarray(points, dtype=float).tolist()))


@lru_cache(maxsize=64)
def _integration_to(count: int, points: tuple[float, ...]) -> Array:
    return angle_basis(count, np.array(points)) @ _from_nodes(count)


@lru_cache(maxsize=16)
def _from_nodes(count: int) -> Array:
    """Legendre coordinates of the interpolant of values at the rule's nodes, (N, N)."""
    return np.asarray(np.linalg.inv(curvature_basis(count, quadrature(count).s)), dtype=np.float64)


def monomial_angle(q: ArrayLike, s: ArrayLike) -> Array:
    """alpha(s) = sum_j q_j s^j / j (eq. 2) for q (..., n) and s (P,): shape (..., P) [rad]."""
    q = np.asarray(q, dtype=float)
    s = np.asarray(s, dtype=float)
    powers = np.stack([s ** (j + 1) / (j + 1) for j in range(q.shape[-1])])
    return q @ powers


def midline(q: ArrayLike, theta: ArrayLike, length: float, s: ArrayLike, nodes: int = 16) -> Array:
    """Positions r(s) = L int_0^s (-sin phi, cos phi) dv in the base frame (eq. 3, base turned by theta).

    q (..., n) [rad], theta (...) [rad], s (P,): shape (..., P, 2) [m]. 16 nodes give 1e-9 L for |alpha| up to pi.
    """
    rule = quadrature(nodes)
    phi = np.asarray(theta, dtype=float)[..., None] + monomial_angle(q, rule.s)
    weights = length * integration_to(nodes, s)
    return np.stack([-np.sin(phi) @ weights.T, np.cos(phi) @ weights.T], axis=-1)
