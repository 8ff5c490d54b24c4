"""The equations of motion, assembled from effects in readable form; numpy or torch, after the arrays it is given.

Generalised coordinates u = (z_1 .. z_n, theta, y_base): curvature, base angle, base position on a rail along y. For every
section: virtual work of f and couple, minus that of inertia, minus that of the bending moment (eq. 8, 16). The
compiled kernel (affine_model.kernel) does the same in another order and is tested against this to 1e-10.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

from affine_model.arm import Arm, parameter_rows
from affine_model.effect import Effect


@dataclass(frozen=True)
class Balance:
    """mass_matrix (..., D, D) and force (..., D) with M u'' = force + external, D = n + 2 (curvatures, theta, rail).

    fluid_force (..., 2) [N] is what the water does to the arm without the reaction to acceleration (eq. 17 where only
    drag acts). Of a sum of effects, so every part is a sum.
    """

    mass_matrix: Any
    force: Any
    fluid_force: Any


def _parameters_of(effect: Effect, parameters: Any) -> SimpleNamespace:
    """The effect's own parameters out of the row (R, ...), each with a trailing axis for the nodes."""
    rows = [row for row in parameter_rows() if row.effect == effect.name]
    return SimpleNamespace(**{row.parameter.name: parameters[row.index][..., None] for row in rows})


def balance(
    arm: Arm,
    effects: tuple[Effect, ...],
    parameters: Any,
    u: Any,
    u_rate: Any,
    t: float = 0.0,
    memory: Any = 0.0,
) -> Balance:
    """Assemble the equations at one state.

    parameters (R, ...), u and u_rate (..., n + 2) in Legendre coordinates; t [s]; memory (..., N) the relaxing curvature of a
    Maxwell branch. Source: eq. 5-17; added mass as in Lighthill 1960 (momentum m_a u_n n, with the couple m_a u_n u_t).
    """
    xp = sys.modules[type(u).__module__.split(".")[0]]
    constant = (lambda a: a) if xp.__name__ == "numpy" else (lambda a: xp.as_tensor(a, dtype=u.dtype, device=u.device))
    n, L = arm.order, arm.specimen.length
    W, w = constant(L * arm.rule.integration), constant(L * arm.rule.weights)
    A, C = constant(arm.angle_basis), constant(arm.curvature_basis)
    node = {name: constant(value) for name, value in arm.node_quantities.items()}

    z, theta, z_rate, theta_rate = u[..., :n], u[..., n : n + 1], u_rate[..., :n], u_rate[..., n : n + 1]
    phi, phi_rate = theta + z @ A.T, theta_rate + z_rate @ A.T
    cos, sin = xp.cos(phi), xp.sin(phi)
    normal, tangent = xp.stack([cos, sin], -1), xp.stack([-sin, cos], -1)  # (..., N, 2)

    def integrate(values: Any) -> Any:  # (..., N, 2), from the base to each node
        return xp.einsum("ik,...kx->...ix", W, values)

    position = integrate(tangent)
    rail = xp.stack([xp.zeros_like(phi), u_rate[..., n + 1 : n + 2] + xp.zeros_like(phi)], -1)
    velocity = integrate(-normal * phi_rate[..., None]) + rail
    acceleration = integrate(-tangent * (phi_rate**2)[..., None])  # the part without u''
    angle_columns = xp.concatenate([A + 0 * phi[..., None], xp.ones_like(phi)[..., None], 0 * phi[..., None]], -1)
    turning = xp.einsum("ik,...kx,...kj->...ixj", W, -normal, angle_columns[..., : n + 1])
    rail_column = xp.stack([xp.zeros_like(phi), xp.ones_like(phi)], -1)[..., None]
    jacobian = xp.concatenate([turning, rail_column], -1)  # (..., N, 2, D), eq. 5
    curvature_columns = xp.concatenate([C + 0 * phi[..., None], xp.zeros_like(angle_columns[..., n:])], -1)

    x = SimpleNamespace(
        **node, **arm.arm_quantities, t=t, memory=memory, phi=phi, phi_rate=phi_rate,
        c=z @ C.T, c_rate=z_rate @ C.T, x=position[..., 0], y=position[..., 1], stiffness=0.0,
    )  # fmt: skip
    own = [(effect, _parameters_of(effect, parameters)) for effect in effects]

    def total(kind: str) -> Any:
        return sum((getattr(effect, kind)(x, p) for effect, p in own if getattr(effect, kind) is not None), 0.0)

    def total_pair(kind: str) -> tuple[Any, Any]:
        pairs = [getattr(effect, kind)(x, p) for effect, p in own if getattr(effect, kind) is not None]
        return sum((pair[0] for pair in pairs), 0.0), sum((pair[1] for pair in pairs), 0.0)

    x.stiffness = total("stiffness") + 0 * phi
    water_x, water_y = total_pair("water_velocity")
    relative_x, relative_y = velocity[..., 0] - water_x, velocity[..., 1] - water_y
    x.u_n = relative_x * cos + relative_y * sin
    x.u_t = -relative_x * sin + relative_y * cos
    x.speed = xp.sqrt(x.u_n**2 + x.u_t**2 + 1e-16)
    step = 1e-4  # the water's own acceleration, by central difference: exact to 1e-8 for motions of a few Hz
    x.t = t + step
    ahead = total_pair("water_velocity")
    x.t = t - step
    behind = total_pair("water_velocity")
    x.t = t
    water_acceleration = [(a - b) / (2 * step) + 0 * phi for a, b in zip(ahead, behind, strict=True)]

    tilt = arm.gravity.angle + total("gravity_tilt") + 0 * phi
    gravity = arm.gravity.magnitude * xp.stack([xp.sin(tilt), xp.cos(tilt)], -1)
    carried, normal_inertia = total("line_inertia") + 0 * phi, total("normal_inertia") + 0 * phi
    force_n, force_t = total_pair("force")
    water = xp.stack(water_acceleration, -1)
    displaced = x.fluid_density * x.area  # the tank's pressure gradient accelerates the displaced water (Froude-Krylov)
    fluid = (force_n + 0 * phi)[..., None] * normal + (force_t + 0 * phi)[..., None] * tangent
    fluid = fluid + (displaced + 0 * phi)[..., None] * water
    # Added mass: f = -d/dt(m_a u_n n), so that the energy is m_a u_n^2 / 2.
    reaction = (x.phi_rate * x.u_t - xp.sum(water * normal, -1))[..., None] * normal
    reaction = reaction + (x.phi_rate * x.u_n)[..., None] * tangent
    fluid = fluid - normal_inertia[..., None] * reaction
    fluid = fluid - (normal_inertia * xp.sum(acceleration * normal, -1))[..., None] * normal
    applied = fluid + (total("weight") + 0 * phi)[..., None] * gravity - carried[..., None] * acceleration
    couple = total("couple") + normal_inertia * x.u_n * x.u_t

    projected = xp.einsum("...ixj,...ix->...ij", jacobian, normal)
    rotary = total("rotary_inertia") + 0 * phi
    M = xp.einsum("i,...i,...ixj,...ixl->...jl", w, carried, jacobian, jacobian)
    M = M + xp.einsum("i,...i,...ij,...il->...jl", w, normal_inertia, projected, projected)
    M = M + xp.einsum("i,...i,...ij,...il->...jl", w, rotary, angle_columns, angle_columns)
    force = xp.einsum("i,...ixj,...ix->...j", w, jacobian, applied)
    force = force + xp.einsum("i,...ij,...i->...j", w, angle_columns, couple + 0 * phi)
    moment = total("bending_moment") + x.stiffness * x.c
    force = force - xp.einsum("i,...ij,...i->...j", w / L, curvature_columns, moment)

    tip_mass = (total("tip_mass") + 0 * phi)[..., -1]
    tip_jacobian = xp.concatenate(
        [xp.einsum("k,...kx,...kj->...xj", w, -normal, angle_columns[..., : n + 1]), rail_column[..., -1, :, :]], -1
    )
    tip_acceleration = xp.einsum("k,...kx->...x", w, -tangent * (phi_rate**2)[..., None])
    M = M + tip_mass[..., None, None] * xp.einsum("...xj,...xl->...jl", tip_jacobian, tip_jacobian)
    tip_force = tip_mass[..., None] * (gravity[..., -1, :] - tip_acceleration)
    force = force + xp.einsum("...xj,...x->...j", tip_jacobian, tip_force)
    return Balance(M, force, xp.einsum("i,...ix->...x", w, fluid))
