"""Batches in the compiled kernel: one arm, many individuals (parameters, initial states, base motions)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from affine_model.advance import PRESCRIBED, Drive, Pace, Rail, Servo, State, advance, at_rest
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
    load (T-1, B) [N] (the force on a load cell at the base along y, with inertia and weight), torque (T-1, B) [N m]
    of the servo. mean_thrust (B,) [N] is the y component of eq. 17 averaged from average_from on (added mass's reaction
    to acceleration included, as in fluid_force); mean_power (B,) [W] = torque times base rate; diverged (B,) [s]: the
    time at which an individual left all bounds, NaN if it did not; its means are NaN. The trajectory arrays are empty
    (T = 0) if stride is 0.
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


@dataclass(frozen=True)
class Timing:
    """step [s]; stride: every stride-th state is kept, 0 keeps none; average_from [s] after the start: where the means
    begin; iterations: Newton iterations a step, of which 1 suffices unless exact energy is wanted; every_effect: as in
    affine_model.advance.Pace.
    """

    step: float
    stride: int = 1
    average_from: float = 0.0
    iterations: int = 1
    every_effect: bool = False

    @property
    def pace(self) -> Pace:
        """The same, counted in steps."""
        first = round(self.average_from / self.step)
        return Pace(self.step, self.stride, first, self.iterations, every_effect=self.every_effect)


@dataclass(frozen=True)
class Start:
    """The state at time t0 [s] in the paper's coordinates, (n, B) each, zero where None: q [rad], q_rate [rad/s], and
    memory [rad], the curvature that a Maxwell branch remembers.
    """

    q: Any = None
    q_rate: Any = None
    memory: Any = None
    t0: float = 0.0


STRAIGHT = Start()


def simulate(
    arm: Arm, parameters: Array, base: Array, timing: Timing, *, start: Start = STRAIGHT, drive: Drive = PRESCRIBED
) -> Batch:
    """Integrate B individuals over the S steps of base.

    parameters (R, B), columns as in arm.parameter_vector. base (3, S, B) or (3, S, 1): theta and its two derivatives
    at the middles of the steps, t0 + (k + 1/2) step; with a servo, the command. Of a base that travels 9 rows: then
    x, y [m], their rates and accelerations. Shapes are counted from the base.
    """
    parameters = np.ascontiguousarray(parameters, dtype=float)
    base = np.ascontiguousarray(base, dtype=float)
    n, count = arm.order, parameters.shape[1]
    if base.shape[0] not in (3, 9) or base.shape[2] not in (1, count):
        raise ValueError(f"base has shape {base.shape}; expected (3 or 9, steps, 1 or {count})")
    state = _start(arm, base, timing.step, start, count)
    course = advance(arm, drive, parameters, base, (np.full(count, float(start.t0)), state), timing.pace)
    u, u_rate, force, summary = course.u, course.u_rate, course.force, course.summary
    if not timing.stride:
        u, u_rate, force = u[:0], u_rate[:0], force[:0]
    times = start.t0 + timing.step * timing.stride * np.arange(len(u), dtype=np.float64)
    sound = summary[4] < 0.0
    return Batch(
        t=times,
        q=np.matmul(arm.to_monomial, u[:, :n]),
        q_rate=np.matmul(arm.to_monomial, u_rate[:, :n]),
        theta=u[:, n],
        theta_rate=u_rate[:, n],
        rail=u[:, n + 1],
        rail_rate=u_rate[:, n + 1],
        force_t=0.5 * (times[1:] + times[:-1]),
        fluid_force=force[: len(times) - 1, :2] if timing.stride else force[:, :2],
        load=force[:, 2],
        torque=force[:, 3],
        mean_thrust=np.where(sound, summary[1], np.nan),
        mean_power=np.where(sound, summary[2], np.nan),
        diverged=np.where(sound, np.nan, summary[4]),
    )


def _start(arm: Arm, base: Array, step: float, start: Start, count: int) -> State:
    """The state before the first step. The base's state follows from that at the middle of the first step, to second
    order.
    """
    n, state = arm.order, at_rest(arm, count)
    if start.q is not None:
        state.u[:n] = arm.from_monomial @ start.q
    if start.q_rate is not None:
        state.u_rate[:n] = arm.from_monomial @ start.q_rate
    state.u[n] = base[0, 0] - 0.5 * step * base[1, 0] + 0.125 * step**2 * base[2, 0]
    state.u_rate[n] = base[1, 0] - 0.5 * step * base[2, 0]
    if start.memory is not None:
        relaxing = [effect.relaxation_time is not None for effect in remembering(tuple(catalogue().values()))]
        state.store[relaxing] = arm.curvature_basis @ arm.from_monomial @ start.memory
    return state
