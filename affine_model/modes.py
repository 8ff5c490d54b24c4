"""Frequencies and shapes of the arm's small vibrations about an equilibrium, by Rayleigh-Ritz on the curvature
coordinates.

Two coordinates give the first frequency of a cone or beam within 0.5 %, but the second 14 to 58 % too high.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from affine_model.arm import Arm, active_effects
from affine_model.curvature import Array
from affine_model.dynamics import balance
from affine_model.statics import DIFFERENCE, equilibrium


@dataclass(frozen=True)
class Modes:
    """Vibrations about the rest shape q (n,), in ascending frequency.

    frequency (n,) [Hz], undamped; NaN where the rest shape is unstable in that mode. damping_ratio (n,) of the
    critical damping. shapes (n, n): column k is mode k in the paper's coordinates, of unit modal mass [rad / sqrt(kg)
    m].
    """

    q: Array
    frequency: Array
    damping_ratio: Array
    shapes: Array


def linearised(arm: Arm, parameters: Array, z: Array, theta: float = 0.0) -> tuple[Array, Array, Array]:
    """(M, D, K), each (n, n), of M z'' + D z' + K z = 0 for small motions about z (n,), Legendre coordinates."""
    n, effects = arm.order, active_effects(parameters)
    u = np.concatenate([z, [theta, 0.0]])
    offsets = DIFFERENCE * np.concatenate([np.eye(n, n + 2), -np.eye(n, n + 2)])
    still = np.zeros_like(offsets)

    def slope(states: Array, rates: Array) -> Array:
        force = balance(arm, effects, parameters, states, rates).force[:, :n]
        return (force[n:] - force[:n]).T / (2.0 * DIFFERENCE)

    mass = balance(arm, effects, parameters, u, np.zeros_like(u)).mass_matrix[:n, :n]
    return mass, slope(u + still, offsets), slope(u + offsets, still)


def modes(arm: Arm, parameters: Array, theta: float = 0.0) -> Modes:
    """Modes about the equilibrium under these parameters (R,), base held at theta [rad].

    The stiffness matrix is made symmetric, which is exact if no steady current bends the arm. Drag is quadratic in the
    speed, so it does not damp small motions in still water. ArithmeticError if there is no equilibrium.
    """
    q = equilibrium(arm, parameters, theta)
    mass, damping, stiffness = linearised(arm, parameters, arm.from_monomial @ q, theta)
    squares, shapes = eigh(0.5 * (stiffness + stiffness.T), mass)
    omega = np.sqrt(np.where(squares > 0.0, squares, np.nan))
    ratio = np.einsum("jk,jl,lk->k", shapes, damping, shapes) / (2.0 * omega)
    return Modes(q, omega / (2.0 * np.pi), ratio, arm.to_monomial @ shapes)
