"""Batches in the compiled kernel: one arm, many individuals (parameters, initial states, base motions)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from affine_model.advance import Drive, Pace, Rail, Servo, State, advance, at_rest
from affine_model.arm import Arm
from affine_model.curvature import Array
from affine_model.dynamics import remembering
from affine_model.effects import catalogue

__all__ = ["Batch", "Rail", "Servo", "simulate"]


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
    n, count = arm.order, parameters.shape[1]
    if base.shape[0] != 3 or base.shape[2] not in (1, count):
        raise ValueError(f"base has shape {base.shape}; expected (3, steps, 1 or {count})")
    state = _start(arm, base, step, q, q_rate, memory, count)
    pace = Pace(step, stride, round(average_from / step), iterations)
    course = advance(arm, Drive(servo, rail), parameters, base, (np.full(count, float(t0)), state), pace)
    u, u_rate, force, summary = course.u, course.u_rate, course.force, course.summary
    if not stride:
        u, u_rate, force = u[:0], u_rate[:0], force[:0]
    times = t0 + step * stride * np.arange(len(u), dtype=np.float64)
    sound = summary[4] < 0.0
    return Batch(
        t=times,
        q=np.einsum("jk,tkb->tjb", arm.to_monomial, u[:, :n]),
        q_rate=np.einsum("jk,tkb->tjb", arm.to_monomial, u_rate[:, :n]),
        theta=u[:, n],
        theta_rate=u_rate[:, n],
        rail=u[:, n + 1],
        rail_rate=u_rate[:, n + 1],
        force_t=0.5 * (times[1:] + times[:-1]),
        fluid_force=force[: len(times) - 1, :2] if stride else force[:, :2],
        load=force[:, 2],
        torque=force[:, 3],
        mean_thrust=np.where(sound, summary[1], np.nan),
        mean_power=np.where(sound, summary[2], np.nan),
        diverged=np.where(sound, np.nan, summary[4]),
    )


def _start(
    arm: Arm, base: Array, step: float, q: Array | None, q_rate: Array | None, memory: Array | None, count: int
) -> State:
    """The state before the first step; the base where the first middle says, to second order, as the kernel goes on."""
    n, state = arm.order, at_rest(arm, count)
    if q is not None:
        state.u[:n] = arm.from_monomial @ q
    if q_rate is not None:
        state.u_rate[:n] = arm.from_monomial @ q_rate
    state.u[n] = base[0, 0] - 0.5 * step * base[1, 0] + 0.125 * step**2 * base[2, 0]
    state.u_rate[n] = base[1, 0] - 0.5 * step * base[2, 0]
    if memory is not None:
        relaxing = [effect.relaxation_time is not None for effect in remembering(tuple(catalogue().values()))]
        state.store[relaxing] = arm.curvature_basis @ arm.from_monomial @ memory
    return state
