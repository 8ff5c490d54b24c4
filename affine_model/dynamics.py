"""The equations of motion, assembled from effects in readable form. They work on numpy arrays and on torch tensors.

Generalised coordinates u = (z_1 .. z_n, theta, y_base): curvature, base angle, base position on a rail along y. A base
that floats freely (affine_model.free_body) has x_base as its last coordinate, too, and the laws see the place in the
tank. Each section adds the virtual work of f and couple, minus that of inertia, minus that of the bending moment (eq.
8, 16). The compiled kernel (affine_model.kernel) computes the same in another order; a test compares both to 1e-10.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

from affine_model.arm import Arm, parameter_rows
from affine_model.effect import Effect
from affine_model.laws import relaxed

BODY_ADDED_MASS = 0.5  # of a compact body, over the water that it displaces: a sphere's (Lamb 1932, art. 92)


@dataclass(frozen=True)
class Balance:
    """mass_matrix (..., D, D) and force (..., D) with M u'' = force + external, D = n + 2 (curvatures, theta, rail), or
    n + 3 (x, too).

    fluid_force (..., 2) [N] is the water's force on the arm without the reaction to acceleration (eq. 17 if only drag
    acts). With this reaction it is fluid_force - fluid_mass @ u'', fluid_mass (..., 2, D). Each part is a sum over the
    effects.
    """

    mass_matrix: Any
    force: Any
    fluid_force: Any
    fluid_mass: Any


@dataclass(frozen=True)
class Instant:
    """Time t [s], one or (..., 1), and the memories (..., S, N) at that time: one slot for each of
    remembering(effects), all 0 if None. travel (..., 6): x, y [m] of a base that travels, their rates and accelerations
    (None: it stands).
    """

    t: Any = 0.0
    memory: Any = None
    travel: Any = None


FRESH = Instant()


@lru_cache(maxsize=32)
def _torch_constants(arm: Arm, dtype: Any, device: Any) -> tuple[tuple[Any, ...], dict[str, Any]]:
    """The arm's arrays on the device, moved there once."""
    torch = sys.modules["torch"]
    arrays, node = _numpy_constants(arm)
    return (
        tuple(torch.as_tensor(array, dtype=dtype, device=device) for array in arrays),
        {name: torch.as_tensor(value, dtype=dtype, device=device) for name, value in node.items()},
    )


def _numpy_constants(arm: Arm) -> tuple[tuple[Any, ...], dict[str, Any]]:
    """L W, L w, angle and curvature bases at the nodes, the angle basis at s = 1, L times the weights of all that
    bends; and the sections' quantities.
    """
    L, rule = arm.specimen.length, arm.rule
    bases = arm.angle_basis, arm.curvature_basis, arm.sections_at([1.0])[0]
    return (L * rule.integration, L * rule.weights, *bases, L * arm.bending_weights), arm.node_quantities


def parameters_of(effect: Effect, parameters: Any) -> SimpleNamespace:
    """The effect's own parameters out of the row (R, ...), each with a trailing axis for the nodes."""
    rows = [row for row in parameter_rows() if row.effect == effect.name]
    return SimpleNamespace(**{row.parameter.name: parameters[row.index][..., None] for row in rows})


def _travelled(travel: Any) -> tuple[Any, Any, Any]:
    """Place, rate and acceleration (..., 1, 2) of the base, each the same for all sections."""
    if travel is None:
        return 0.0, 0.0, 0.0
    return travel[..., None, 0:2], travel[..., None, 2:4], travel[..., None, 4:6]


def _last(of_sections: Any) -> Any:
    """The values of the last section (..., 2)."""
    return of_sections if isinstance(of_sections, float) else of_sections[..., -1, :]


def balance(
    arm: Arm, effects: tuple[Effect, ...], parameters: Any, u: Any, u_rate: Any, instant: Instant = FRESH
) -> Balance:
    """Assemble the equations at one state.

    parameters (R, ...), u and u_rate (..., D) in Legendre coordinates. Source: eq. 5-17; added mass as in
    Lighthill 1960 (momentum m_a u_n n, with the couple m_a u_n u_t).
    """
    xp = sys.modules[type(u).__module__.split(".")[0]]
    n, L = arm.order, arm.specimen.length
    known = _numpy_constants(arm) if xp.__name__ == "numpy" else _torch_constants(arm, u.dtype, u.device)
    (W, w, A, C, end, bending), node = known

    z, theta, z_rate, theta_rate = u[..., :n], u[..., n : n + 1], u_rate[..., :n], u_rate[..., n : n + 1]
    phi, phi_rate = theta + z @ A.T, theta_rate + z_rate @ A.T
    cos, sin = xp.cos(phi), xp.sin(phi)
    normal, tangent = xp.stack([cos, sin], -1), xp.stack([-sin, cos], -1)  # (..., N, 2)

    def integrate(values: Any) -> Any:  # (..., N, 2), from the base to each node
        return xp.einsum("ik,...kx->...ix", W, values)

    position = integrate(tangent)
    free, still = u.shape[-1] > n + 2, xp.zeros_like(phi)
    rail = xp.stack([u_rate[..., n + 2 :] + still if free else still, u_rate[..., n + 1 : n + 2] + still], -1)
    path, going, pushed = _travelled(instant.travel)
    if free:
        path = path + xp.stack([u[..., n + 2 :] + still, u[..., n + 1 : n + 2] + still], -1)
    velocity = integrate(-normal * phi_rate[..., None]) + rail + going
    acceleration = integrate(-tangent * (phi_rate**2)[..., None]) + pushed  # the part without u''
    unturned = [0 * phi[..., None]] * (u.shape[-1] - n - 1)
    angle_columns = xp.concatenate([A + 0 * phi[..., None], xp.ones_like(phi)[..., None], *unturned], -1)
    swings = -normal[..., None] * angle_columns[..., None, : n + 1]  # (..., N, 2, n + 1)
    turning = (W @ swings.reshape(*swings.shape[:-2], -1)).reshape(swings.shape)
    base_columns = xp.stack([still, xp.ones_like(phi)], -1)[..., None]
    if free:
        base_columns = xp.concatenate([base_columns, xp.stack([xp.ones_like(phi), still], -1)[..., None]], -1)
    jacobian = xp.concatenate([turning, base_columns], -1)  # (..., N, 2, D), eq. 5
    curvature_columns = xp.concatenate([C + 0 * phi[..., None], xp.zeros_like(angle_columns[..., n:])], -1)

    place = position + path
    x = SimpleNamespace(
        **node, **arm.arm_quantities, t=instant.t, phi=phi, phi_rate=phi_rate,
        c_rate=z_rate @ C.T, x=place[..., 0], y=place[..., 1], stiffness=0.0, drag_coefficient=0.0,
    )  # fmt: skip
    own = [(effect, parameters_of(effect, parameters)) for effect in effects]

    def total(kind: str) -> Any:
        return sum((getattr(effect, kind)(x, p) for effect, p in own if getattr(effect, kind) is not None), 0.0)

    def total_pair(kind: str) -> tuple[Any, Any]:
        pairs = [getattr(effect, kind)(x, p) for effect, p in own if getattr(effect, kind) is not None]
        return sum((pair[0] for pair in pairs), 0.0), sum((pair[1] for pair in pairs), 0.0)

    x.c = z @ C.T - total("natural_curvature")
    x.stiffness = total("stiffness") + 0 * phi
    for effect, p in own:
        if effect.stiffness_share is not None:
            x.stiffness = x.stiffness * (1.0 + effect.stiffness_share(x, p))
    x.drag_coefficient = total("drag_coefficient") + 0 * phi
    water_x, water_y = total_pair("water_velocity")
    relative_x, relative_y = velocity[..., 0] - water_x, velocity[..., 1] - water_y
    x.u_n = relative_x * cos + relative_y * sin
    x.u_t = -relative_x * sin + relative_y * cos
    x.speed = xp.sqrt(x.u_n**2 + x.u_t**2 + 1e-16)
    step = 1e-4  # the water's own acceleration, by central difference: exact to 1e-8 for motions of a few Hz
    x.t = instant.t + step
    ahead = total_pair("water_velocity")
    x.t = instant.t - step
    behind = total_pair("water_velocity")
    x.t = instant.t
    water_acceleration = [(a - b) / (2 * step) + 0 * phi for a, b in zip(ahead, behind, strict=True)]

    tilt = arm.gravity.angle + total("gravity_tilt") + 0 * phi
    gravity = arm.gravity.magnitude * xp.stack([xp.sin(tilt), xp.cos(tilt)], -1)
    carried, normal_inertia = total("line_inertia") + 0 * phi, total("normal_inertia") + 0 * phi
    carried_water = total("carried_water") + 0 * phi
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
    fluid = fluid - carried_water[..., None] * (acceleration - water)
    applied = fluid + (total("weight") + 0 * phi)[..., None] * gravity - carried[..., None] * acceleration
    couple = total("couple") + normal_inertia * x.u_n * x.u_t

    projected = xp.sum(jacobian * normal[..., None], -2)
    rotary = total("rotary_inertia") + 0 * phi
    carried_all = w * (carried + carried_water)
    motions = xp.concatenate([jacobian[..., 0, :], jacobian[..., 1, :], projected, angle_columns], -2)  # (..., 4 N, D)
    inertia = xp.concatenate([carried_all, carried_all, w * normal_inertia, w * rotary], -1)
    M = xp.swapaxes(motions * inertia[..., None], -1, -2) @ motions
    force = xp.einsum("...ixj,...ix->...j", jacobian, w[:, None] * applied)
    force = force + xp.einsum("...ij,...i->...j", angle_columns, w * couple + 0 * phi)
    moment = x.stiffness * x.c
    slots = {effect.name: slot for slot, effect in enumerate(remembering(effects))}
    for effect, p in own:
        if effect.bending_moment is not None:
            slot = slots.get(effect.name)
            x.memory = 0.0 * phi if instant.memory is None or slot is None else instant.memory[..., slot, :]
            moment = moment + effect.bending_moment(x, p)
    force = force - xp.einsum("...ij,...i->...j", curvature_columns, bending / L * moment)

    fluid_force = xp.einsum("i,...ix->...x", w, fluid)
    fluid_mass = xp.einsum("...ix,...ij->...xj", (w * normal_inertia)[..., None] * normal, projected)
    fluid_mass = fluid_mass + xp.einsum("...i,...ixj->...xj", w * carried_water, jacobian)

    # Compact bodies at the tip: the payload, and an undeclared body.
    end_columns = xp.concatenate([end + 0 * z, xp.ones_like(theta)], -1)
    end_phi, end_rate = theta[..., 0] + z @ end, theta_rate[..., 0] + z_rate @ end
    end_normal = xp.stack([xp.cos(end_phi), xp.sin(end_phi)], -1)
    end_tangent = xp.stack([-xp.sin(end_phi), xp.cos(end_phi)], -1)
    tip_turning = xp.einsum("k,...kxj->...xj", w, swings)
    tip_centripetal = xp.einsum("k,...kx->...x", w, -tangent * (phi_rate**2)[..., None])
    along, aside = ((part + 0 * phi)[..., -1, None] for part in total_pair("payload_shift"))
    for effect, p in own:
        if effect.hung_mass is None:
            continue
        mass, reach, drop, density = ((part + 0 * phi)[..., -1, None] for part in effect.hung_mass(x, p))
        if effect.family == "base":  # the declared payload
            reach, drop = reach + along, drop + aside
        displaced = x.fluid_density * mass / density
        carries = BODY_ADDED_MASS * displaced
        lever = drop * end_tangent - reach * end_normal  # d (reach t + drop n) / d phi
        turning = tip_turning + xp.einsum("...x,...j->...xj", lever, end_columns)
        columns = xp.concatenate([turning, base_columns[..., -1, :, :]], -1)
        acceleration = (
            tip_centripetal + _last(pushed) - (reach * end_tangent + drop * end_normal) * (end_rate**2)[..., None]
        )
        M = M + (mass + carries)[..., None] * xp.einsum("...xj,...xl->...jl", columns, columns)
        flow = (displaced + carries) * water[..., -1, :] - carries * acceleration
        pull = (mass - displaced) * gravity[..., -1, :] - mass * acceleration + flow
        force = force + xp.einsum("...xj,...x->...j", columns, pull)
        fluid_force = fluid_force + flow
        fluid_mass = fluid_mass + carries[..., None] * columns
    if any(effect.tip_force is not None for effect in effects):
        tip_place = xp.einsum("k,...kx->...x", w, tangent) + _last(path)
        going = xp.einsum("k,...kx->...x", w, -normal * phi_rate[..., None]) + rail[..., -1, :] + _last(going)
        going = going - xp.stack([water_x + 0 * phi, water_y + 0 * phi], -1)[..., -1, :]
        end_n, end_t = xp.sum(going * end_normal, -1), xp.sum(going * end_tangent, -1)
        here = SimpleNamespace(
            **arm.arm_quantities, t=instant.t, x=tip_place[..., 0], y=tip_place[..., 1], phi=end_phi, phi_rate=end_rate,
            u_n=end_n, u_t=end_t, speed=xp.sqrt(end_n**2 + end_t**2 + 1e-16),
        )  # fmt: skip
        columns = xp.einsum("...x,...j->...xj", 0.0 * end_normal, end_columns) + tip_turning
        columns = xp.concatenate([columns, base_columns[..., -1, :, :]], -1)
        for effect, p in own:
            if effect.tip_force is not None:
                at_tip = SimpleNamespace(**{name: value[..., 0] for name, value in vars(p).items()})
                along_n, along_t = (part + 0 * end_phi for part in effect.tip_force(here, at_tip))
                pull = along_n[..., None] * end_normal + along_t[..., None] * end_tangent
                force = force + xp.einsum("...xj,...x->...j", columns, pull)
                fluid_force = fluid_force + pull
    return Balance(M, force, fluid_force, fluid_mass)


def remembering(effects: tuple[Effect, ...]) -> tuple[Effect, ...]:
    """The effects with a memory, in the order of its slots."""
    return tuple(effect for effect in effects if effect.remembers)


def advanced_memory(
    arm: Arm, effects: tuple[Effect, ...], parameters: Any, memory: Any, c_rate: Any, duration: float
) -> Any:
    """Memory (..., S, N), a slot for each of remembering(effects), after `duration` [s] at the rates of curvature
    c_rate (..., N).

    A Maxwell branch follows laws.relaxed. A friction element follows memory' = c', cut at the yield curvature.
    """
    xp = sys.modules[type(c_rate).__module__.split(".")[0]]
    x = SimpleNamespace(**arm.arm_quantities)
    slots = []
    for slot, effect in enumerate(remembering(effects)):
        p, kept = parameters_of(effect, parameters), memory[..., slot, :]
        if effect.relaxation_time is not None:
            tau = effect.relaxation_time(x, p) + 0.0 * c_rate
            slots.append(relaxed(kept, c_rate, duration, tau))
        else:
            assert effect.yield_curvature is not None
            limit = effect.yield_curvature(x, p) + 0.0 * c_rate
            slots.append(xp.minimum(xp.maximum(kept + duration * c_rate, -limit), limit))
    return xp.stack(slots, -2) if slots else memory
