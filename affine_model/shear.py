"""Shear of thick sections (Timoshenko 1921), slaved to the bending moment.

    gamma = Q / (kappa G A),    Q = -d/ds (E I c / L) / L,    G = E / 3:
    gamma(s) = -3 f (I c)' / (kappa A L^2)
    phi = psi + gamma,          2 U = int E I / L c^2 + E kappa A L / (3 f) gamma^2 ds

psi: the turn of a section, c = psi' the curvature of bending; phi: the direction of the midline, with the curvature
phi' = c + gamma' whose coordinates are q. f: specimen.shear_compliance. Q is the shear force that the bending moment
needs in equilibrium, so that no coordinate is added. The elastic energy has the exact minimum for a prismatic arm under
a load at its tip: w = F L^3 / (3 E I) + F L / (kappa G A). Viscous moments shear the arm in proportion.
kappa of an incompressible section: Cowper 1966 (J. Appl. Mech. 33, 335).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import ArrayLike

from affine_model.curvature import Array, legendre_to_monomial, quadrature
from tentacle.errors import InputError
from tentacle.specimen import MOST_SHEAR, Specimen

MOST_CONDITION = 1e4  # by which c, found from the midline, may have larger errors than it: half the digits are left
ROOM = 0.1  # of it, within which a fit moves the compliance: thickness and length may be uncertain too
SECTION_DEGREE = 4  # of I(s) of a cone


@dataclass(frozen=True)
class Shear:
    """gamma (n + 1, n): coefficients of s^0 .. s^n of the shear angle, and bending (n, n): those of c, by the
    coordinates q.
    """

    gamma: Array
    bending: Array

    def angles(self, s: ArrayLike) -> Array:
        """d gamma / dq at s (P,): shape (P, n)."""
        return np.asarray(np.vander(np.asarray(s, dtype=float), len(self.gamma), increasing=True) @ self.gamma)


def shear_of(specimen: Specimen, order: int) -> Shear:
    """The shear of an arm's sections with so many coordinates.

    InputError where the arm is so thick, for its number of coordinates, that the midline hardly shows how it bends.
    """
    gamma = _by_bending(specimen, order)
    midline = _midline(gamma)
    if _condition(midline) > MOST_CONDITION:
        expected = f"a smaller one, 0, or fewer than {order} coordinates: this arm is thick"
        raise InputError(f"{specimen.shear_compliance:g} is not usable", field="shear_compliance", expected=expected)
    bending: Array = np.asarray(np.linalg.inv(midline), dtype=np.float64)
    return Shear(gamma @ bending, bending)


def most_compliance(specimen: Specimen, order: int) -> float:
    """The largest shear_compliance with which an arm of so many coordinates can be fitted."""
    solid = _by_bending(replace(specimen, shear_compliance=1.0), order)
    low, high = 0.0, MOST_SHEAR
    for _ in range(20):  # to a millionth: gamma is linear in it
        middle = 0.5 * (low + high)
        fits = _condition(_midline(middle * solid)) <= ROOM * MOST_CONDITION
        low, high = (middle, high) if fits else (low, middle)
    return low


def _midline(gamma: Array) -> Array:
    """Coordinates q of the midline by those of c: phi' = c + gamma'."""
    order = gamma.shape[1]
    return np.asarray(np.eye(order) + np.arange(1, order + 1)[:, None] * gamma[1:])


def _condition(midline: Array) -> float:
    """The condition of that matrix in Legendre coordinates; inf where a larger shear turned a coordinate's sign."""
    if np.min(np.diag(midline)) <= 0.0:
        return np.inf
    to_monomial = legendre_to_monomial(len(midline))
    return float(np.linalg.cond(np.linalg.solve(to_monomial, midline @ to_monomial)))


def energy_turned(basis: Array, shear: Array, weights: tuple[Array, Array]) -> Array:
    """A basis of curvature (N, n) whose square has the energy of bending and shear together.

    basis, shear (N, n): dc/dz and d gamma/dz at the nodes; weights (N,) of both squares in the energy.
    """
    bent = basis.T @ (weights[0][:, None] * basis)
    both = bent + shear.T @ (weights[1][:, None] * shear)
    return np.asarray(basis @ np.linalg.solve(np.linalg.cholesky(bent).T, np.linalg.cholesky(both).T))


def shear_stiffness(specimen: Specimen, s: Array) -> Array:
    """kappa A L^2 / (3 f) at s (P,) [m^4]: what gamma^2 weighs in the energy where I weighs c^2."""
    section = specimen.section
    return section.shear_coefficient * section.area(s) * specimen.length**2 / (3.0 * specimen.shear_compliance)


def _by_bending(specimen: Specimen, order: int) -> Array:
    """Coefficients (n + 1, n) of gamma by those of c: of a prism or a cone (I c)' / A is a polynomial."""
    s = quadrature(order + SECTION_DEGREE + 2).s
    weight, columns = shear_stiffness(specimen, s), []
    for j in range(order):
        moment = Polynomial.fit(s, specimen.section.second_moment(s) * s**j, order + SECTION_DEGREE, domain=[0, 1])
        gamma = Polynomial.fit(s, -moment.deriv()(s) / weight, order, domain=[0, 1]).convert(domain=[-1, 1])
        columns.append(np.pad(gamma.coef, (0, order + 1 - gamma.coef.size)))
    return np.array(columns).T
