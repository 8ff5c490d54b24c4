"""Batches in the compiled kernel: one arm, many individuals (parameters, initial states, base motions)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from affine_model.arm import Arm, active_effects
from affine_model.curvature import Array, angle_basis
from affine_model.dynamics import remembering
from affine_model.effects import catalogue
from affine_model.kernel import advance_blocks


@dataclass(frozen=True)
class Servo:
    """PID servo: stiffness [N m/rad], integral [N m/(rad s)], damping [N m s/rad], torque_limit [N m],
    rotor_inertia [kg m^2].
    """

    stiffness: float
    damping: float
    torque_limit: float
    integral: float = 0.0
    rotor_inertia: float = 1e-5


@dataclass(frozen=True)
class Rail:
    """The base slides along y: carriage mass [kg], viscous friction [N s/m], dry friction [N],
    smoothed at slip_speed [m/s].
    """

    mass: float
    viscous: float = 0.0
    dry: float = 0.0
    slip_speed: float = 1e-3


@dataclass(frozen=True)
class Batch:
    """The outcome of a batch of B individuals.

    t (T,) [s]; q, q_rate (T, n, B) the paper's coordinates; theta, theta_rate (T, B); rail, rail_rate (T, B) [m];
    force_t (T-1,) [s], the middles of the output intervals, and over each the means of: fluid_force (T-1, 2, B) [N],
    load (T-1, B) [N] (what a load cell at the base feels along y, inertia and weight included), torque (T-1, B) [N m]
    of the servo. mean_thrust (B,) [N] is the y component of eq. 17 averaged from average_from on (added mass's reaction
    to acceleration included, as in fluid_force); mean_power (B,) [W] = torque times base rate; diverged (B,) [s]: when
    an individual left all bounds, NaN where it did not; its means are NaN. The trajectory arrays are empty (T = 0)
    where none were asked for.
    """

    t: Array
    q: Array
    q_rate: Array
    theta: Array
    theta_rate: Array
    rail: Array
    rail_rate: Array
    force_t: Array
    fluid_force: Array
    load: Array
    torque: Array
    mean_thrust: Array
    mean_power: Array
    diverged: Array


def simulate(
    arm: Arm,
    parameters: Array,
    base: Array,
    step: float,
    *,
    q: Array | None = None,
    q_rate: Array | None = None,
    memory: Array | None = None,
    servo: Servo | None = None,
    rail: Rail | None = None,
    t0: float = 0.0,
    stride: int = 1,
    average_from: float = 0.0,
    iterations: int = 1,
) -> Batch:
    """Integrate B individuals over S steps of `step` seconds.

    parameters (R, B), columns as in arm.parameter_vector. base (3, S, B) or (3, S, 1): theta and its two derivatives
    at the middles of the steps, t0 + (k + 1/2) step; with a servo, the command. q, q_rate (n, B): initial state in
    the paper's coordinates, zero if None; memory (n, B): the curvature that a Maxwell branch remembers then,
    likewise. stride: keep every stride-th step, 0 keeps none. average_from [s] after t0: start of the means.
    iterations: Newton iterations a step; 1 suffices unless exact energy is wanted.
    """
    parameters = np.ascontiguousarray(parameters, dtype=float)
    base = np.ascontiguousarray(base, dtype=float)
    n, count, steps = arm.order, parameters.shape[1], base.shape[1]
    if base.shape[0] != 3 or base.shape[2] not in (1, count):
        raise ValueError(f"base has shape {base.shape}; expected (3, steps, 1 or {count})")
    start, start_rate = np.zeros((n + 2, count)), np.zeros((n + 2, count))
    start[:n] = 0.0 if q is None else arm.from_monomial @ q
    start_rate[:n] = 0.0 if q_rate is None else arm.from_monomial @ q_rate
    # From the first middle back to the start, to second order, as the kernel does forward.
    start[n] = base[0, 0] - 0.5 * step * base[1, 0] + 0.125 * step**2 * base[2, 0]
    start_rate[n] = base[1, 0] - 0.5 * step * base[2, 0]
    kept = steps // stride if stride else 0
    out_u, out_rate = np.zeros((kept + 1, n + 2, count)), np.zeros((kept + 1, n + 2, count))
    out_force, summary = np.zeros((max(kept, 1), 4, count)), np.zeros((5 + 2 * (n + 2), count))
    slots = remembering(tuple(catalogue().values()))
    start_store = np.zeros((len(slots), arm.nodes, count))
    if memory is not None:
        relaxing = [effect.relaxation_time is not None for effect in slots]
        start_store[relaxing] = arm.curvature_basis @ arm.from_monomial @ memory
    node, whole = arm.node_quantities, arm.arm_quantities
    names = ("length", "density", "fluid_density", "payload", "gravity")
    constants = (*(whole[k] for k in (*names, "payload_reach", "payload_drop", "payload_density")), arm.gravity.angle)
    acting = {effect.name for effect in active_effects(parameters)}
    active = np.array([name in acting for name in catalogue()])
    columns = np.zeros((arm.nodes, n + 2))
    angle, curvature, end = columns.copy(), columns, np.zeros(n + 2)
    end[:n], end[n] = angle_basis(n, [1.0])[0], 1.0
    angle[:, :n], angle[:, n], curvature[:, :n] = arm.angle_basis, 1.0, arm.curvature_basis
    length, rule = arm.specimen.length, arm.rule
    servo_row = np.zeros(5)
    if servo is not None:
        servo_row[:] = servo.stiffness, servo.integral, servo.damping, servo.torque_limit, servo.rotor_inertia
    rail_row = np.array([0.0, 0.0, 0.0, 1.0] if rail is None else [rail.mass, rail.viscous, rail.dry, rail.slip_speed])
    advance_blocks(
        arm.nodes, n, count, parameters, active, constants, node["s"], node["area"], node["second_moment"],
        node["width"], node["perimeter"], length * rule.integration, length * rule.weights, rule.weights, angle, end,
        curvature, base, servo_row, rail_row, servo is not None, rail is not None, step, steps, start, start_rate,
        start_store, iterations, stride, round(average_from / step), t0, out_u, out_rate, out_force, summary,
    )  # fmt: skip
    if not stride:
        out_u, out_rate, out_force = out_u[:0], out_rate[:0], out_force[:0]
    times = t0 + step * stride * np.arange(len(out_u), dtype=np.float64)
    return Batch(
        t=times,
        q=np.einsum("jk,tkb->tjb", arm.to_monomial, out_u[:, :n]),
        q_rate=np.einsum("jk,tkb->tjb", arm.to_monomial, out_rate[:, :n]),
        theta=out_u[:, n],
        theta_rate=out_rate[:, n],
        rail=out_u[:, n + 1],
        rail_rate=out_rate[:, n + 1],
        force_t=0.5 * (times[1:] + times[:-1]),
        fluid_force=out_force[: len(times) - 1, :2] if stride else out_force[:, :2],
        load=out_force[:, 2],
        torque=out_force[:, 3],
        mean_thrust=np.where(summary[4] < 0.0, summary[1], np.nan),
        mean_power=np.where(summary[4] < 0.0, summary[2], np.nan),
        diverged=np.where(summary[4] < 0.0, np.nan, summary[4]),
    )
