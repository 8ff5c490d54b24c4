"""Equilibrium of the arm at rest: generalised forces in balance, found by Newton's method (eq. 8 without motion)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from affine_model.arm import Arm, active_effects
from affine_model.curvature import Array
from affine_model.dynamics import Instant, balance

DIFFERENCE = 1e-5  # rad; central differences of smooth forces: 1e-10 relative


@dataclass(frozen=True)
class TipLoad:
    """A dead load at s = 1: force (x, y) [N] in the base frame, moment [N m]."""

    force: tuple[float, float] = (0.0, 0.0)
    moment: float = 0.0


UNLOADED = TipLoad()


def tip_load(arm: Arm, z: Array, theta: float, load: TipLoad) -> Array:
    """Generalised force (..., n) of a dead load at s = 1.

    z (..., n) are Legendre coordinates. By virtual work: dr_tip/dz . force + d alpha_tip/dz moment.
    """
    phi = theta + z @ arm.angle_basis.T
    arm_of_force = -(np.cos(phi) * load.force[0] + np.sin(phi) * load.force[1]) * arm.specimen.length * arm.rule.weights
    return arm_of_force @ arm.angle_basis + load.moment * arm.sections_at([1.0])[0]


def static_force(arm: Arm, parameters: Array, z: Array, theta: float = 0.0, t: float = 0.0) -> Array:
    """Generalised force (..., n) on the curvature coordinates z (..., n) of the arm at rest (memory relaxed)."""
    u = np.concatenate([z, np.full((*z.shape[:-1], 1), theta), np.zeros((*z.shape[:-1], 1))], axis=-1)
    return balance(arm, active_effects(parameters), parameters, u, np.zeros_like(u), Instant(t)).force[..., : arm.order]


def equilibrium(
    arm: Arm,
    parameters: Array,
    theta: float = 0.0,
    *,
    load: TipLoad = UNLOADED,
    start: Array | None = None,
    t: float = 0.0,
) -> Array:
    """Curvatures q (n,) at which the arm rests with its base held at theta [rad].

    parameters (R,). start: first guess q (n,),
    straight if None. Newton's method with the step halved while the forces do not fall. ArithmeticError where it finds
    no rest in 100 steps.
    """
    z = np.zeros(arm.order) if start is None else arm.from_monomial @ np.asarray(start, dtype=float)
    offsets = DIFFERENCE * np.concatenate([np.eye(arm.order), -np.eye(arm.order)])

    def forces(points: Array) -> Array:
        external = tip_load(arm, points, theta, load)
        return static_force(arm, parameters, points, theta, t) + external

    scale = np.max(np.abs(forces(offsets / DIFFERENCE))) + 1e-300
    force = forces(z)
    for _ in range(100):
        if np.max(np.abs(force)) <= 1e-13 * scale:
            return arm.to_monomial @ z
        values = forces(z + offsets)
        slope = (values[: arm.order] - values[arm.order :]).T / (2.0 * DIFFERENCE)
        step = -np.linalg.solve(slope, force)
        step *= min(1.0, 2.0 / np.max(np.abs(step)))  # two radians at most: forces are periodic in angles
        for _ in range(12):
            tried = forces(z + step)
            if np.linalg.norm(tried) < np.linalg.norm(force):
                break
            step *= 0.5
        else:
            break
        z, force = z + step, tried
    if np.max(np.abs(force)) <= 1e-9 * scale:  # only rounding prevents smaller forces
        return arm.to_monomial @ z
    raise ArithmeticError(
        f"no equilibrium found at theta = {theta:.3g} rad: forces of {np.max(np.abs(force)):.2g} remain"
    )
