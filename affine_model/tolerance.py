"""Simulation to a tolerance: the step is made finer until two solutions agree (step doubling, Richardson 1911)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from affine_model.advance import PRESCRIBED, Drive
from affine_model.arm import Arm
from affine_model.curvature import Array
from affine_model.simulate import STRAIGHT, Batch, Start, Timing, simulate

ORDER = 2  # of the midpoint rule: the error falls with the square of the step
COARSEST, FINEST = 1 / 100, 1 / 100_000  # s
MARGIN = 1.2  # finer than the estimate asks for


@dataclass(frozen=True)
class Controlled:
    """batch: B individuals at the asked spacing, each from its own step (B,) [s]; error (B,) [rad]: the estimated
    largest error of the angle phi anywhere along the arm at any output instant, NaN where the individual diverged.
    """

    batch: Batch
    step: Array
    error: Array


@dataclass(frozen=True)
class Goal:
    """duration [s]; tolerance [rad] of every angle along the arm; spacing [s] of the output; average_from [s] after the
    start: where the means begin.
    """

    duration: float
    tolerance: float
    spacing: float = 1 / 50
    average_from: float = 0.0


def _difference(arm: Arm, a: Batch, b: Batch) -> Array:
    """Largest difference of phi along the arm over all instants (B,) [rad]; of the rail, over the length,
    where there is one.
    """
    z = np.einsum("jk,tkb->tjb", arm.from_monomial, a.q - b.q)
    angle = np.abs(np.einsum("ij,tjb->tib", arm.angle_basis, z) + (a.theta - b.theta)[:, None])
    return np.maximum(angle.max(axis=(0, 1)), np.abs(a.rail - b.rail).max(axis=0) / arm.specimen.length)


def _columns(batch: Batch, index: NDArray[np.intp]) -> Batch:
    """The individuals of these places."""
    shared = ("t", "force_t")
    return replace(batch, **{f.name: getattr(batch, f.name)[..., index] for f in fields(batch) if f.name not in shared})


def _place(whole: Batch, part: Batch, index: NDArray[np.intp]) -> Batch:
    """The batch with the individuals of these places replaced."""
    changed = {}
    for field in fields(whole):
        if field.name not in ("t", "force_t"):
            array = getattr(whole, field.name).copy()
            array[..., index] = getattr(part, field.name)
            changed[field.name] = array
    return replace(whole, **changed)


def simulate_to_tolerance(
    arm: Arm,
    parameters: Array,
    base: Callable[[Array], Array],
    goal: Goal,
    *,
    start: Start = STRAIGHT,
    drive: Drive = PRESCRIBED,
) -> Controlled:
    """Integrate B individuals so that no angle along the arm errs by more than the goal's tolerance.

    parameters (R, B); base: a function of times (S,) that gives (3, S) or (3, S, B), such as a waveform. Individuals
    that meet the tolerance are not computed again. ArithmeticError where the tolerance is not met at a
    step of 10 us.
    """
    count = parameters.shape[1]

    def run(index: NDArray[np.intp], substeps: int) -> Batch:
        h = goal.spacing / substeps
        table = base(start.t0 + h * (np.arange(round(goal.duration / goal.spacing) * substeps, dtype=np.float64) + 0.5))
        table = table[..., None] if table.ndim == 2 else table[..., index]
        given = (None if value is None else value[:, index] for value in (start.q, start.q_rate, start.memory))
        timing = Timing(h, substeps, goal.average_from)
        return simulate(arm, parameters[:, index], table, timing, start=Start(*given, t0=start.t0), drive=drive)

    pending, substeps = np.arange(count), max(1, int(np.ceil(goal.spacing / COARSEST)))
    coarse = run(pending, substeps)
    whole, error, step = coarse, np.full(count, np.nan), np.full(count, goal.spacing / substeps)
    finer = 2 * substeps
    while pending.size:
        fine = run(pending, finer)
        estimate = _difference(arm, coarse, fine) / ((finer / substeps) ** ORDER - 1.0)
        lost = np.isfinite(fine.diverged)
        estimate[lost] = np.nan
        whole = _place(whole, fine, pending)
        error[pending], step[pending] = estimate, goal.spacing / finer
        again = np.flatnonzero((estimate > goal.tolerance) | (lost & ~np.isfinite(coarse.diverged)))
        if again.size == 0:
            break
        growth = np.sqrt(max(np.nanmax(np.append(estimate[again], 4.0 * goal.tolerance)) / goal.tolerance, 4.0))
        if goal.spacing / finer <= FINEST:
            worst = np.nanmax(estimate)
            raise ArithmeticError(f"an error of {worst:.2g} rad remains at a step of {goal.spacing / finer:.2g} s")
        substeps, coarse, pending = finer, _columns(fine, again), pending[again]
        finer = min(int(np.ceil(finer * min(growth * MARGIN, 16.0))), int(np.ceil(goal.spacing / FINEST)))
    return Controlled(whole, step, error)
