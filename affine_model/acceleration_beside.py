"""Acceleration of points on the arm and beside its axis, and what an accelerometer there measures of it.

    r''(s, d) = L int_0^s (-n phi'' - t phi'^2) dv + d (t phi'' - n phi'^2)        (the second derivative of x(s, d))
    f = r'' - g,      n = (cos phi, sin phi),  t = (-sin phi, cos phi),  phi(s) = theta + sum_j q_j s^j / j   (eq. 1-4)

f: the specific force. An accelerometer measures it along its own axes, which turn with the arm.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from affine_model.arm import Arm
from affine_model.curvature import Array, integration_to, quadrature
from affine_model.dynamics import parameters_of
from affine_model.effects import catalogue

NODES = 16  # as in `affine_model.curvature.midline`


@dataclass(frozen=True)
class Turning:
    """The arm's directions over time: coordinates q, q', q'' (3, T, n, B) [rad] in the paper's, direction theta of the
    root and its derivatives (3, T, B) [rad]. shear (n + 1, n): as in points_beside.
    """

    q: Array
    theta: Array
    shear: Array | None = None

    def angles(self, s: Array) -> Array:
        """phi, phi', phi'' (3, T, B, P) of the midline at s (P,); the last is that of the section there."""
        j = np.arange(1.0, self.q.shape[2] + 1.0)
        rows = s[:, None] ** j / j
        if self.shear is not None:
            rows[-1] -= np.vander(s[-1:], len(self.shear), increasing=True)[0] @ self.shear
        return self.theta[..., None] + np.einsum("pj,dtjb->dtbp", rows, self.q)


def specific_force(turning: Turning, pull: Array, length: float, place: tuple[float, float]) -> tuple[Array, Array]:
    """f (T, B) [m/s^2] along the normal and along the tangent at the place (s, d).

    pull (T, 2, B): gravity minus the acceleration of the base from which the arm's points are counted.
    """
    s, d = place
    phi, rate, acceleration = turning.angles(np.append(quadrature(NODES).s, s))
    cos, sin, square = np.cos(phi), np.sin(phi), rate**2
    weights = np.append(length * integration_to(NODES, [s])[0], 0.0)
    x = (sin * square - cos * acceleration) @ weights - pull[:, 0]
    y = (-cos * square - sin * acceleration) @ weights - pull[:, 1]
    cos, sin = cos[..., -1], sin[..., -1]
    return x * cos + y * sin - d * square[..., -1], y * cos - x * sin + d * acceleration[..., -1]


def gravity_of(arm: Arm, parameters: Array) -> Array:
    """Gravity (2, B) [m/s^2] in the standing frame under the parameters (R, B), tilted by every law of the catalogue
    that tilts it, as in affine_model.dynamics.
    """
    x, angle = SimpleNamespace(**arm.arm_quantities), np.full(parameters.shape[1:], arm.gravity.angle)
    for effect in catalogue().values():
        if effect.gravity_tilt is not None:
            angle = angle + effect.gravity_tilt(x, parameters_of(effect, parameters))[..., 0]
    return np.asarray(arm.gravity.magnitude * np.stack([np.sin(angle), np.cos(angle)]))
