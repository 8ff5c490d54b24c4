"""A fit at a coarser step, corrected by the step's error where the fit stands (deferred correction).

    r(u) ~= r_H(u) + d,        d = r_h(u_0) - r_H(u_0),        H = COARSER h

r_h: residuals simulated with the step h that the problem asks for; u_0: where the correction was measured. The step's
error changes slowly with the unknowns, so that d holds nearby. The fit begins again with d at its end, until d changes
the cost no more: its residuals are then those of the step h, and only the derivatives have the relative error of H.
Sources: Stetter 1978 (deferred correction); Bandler et al. 1994 (space mapping).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from affine_model.curvature import Array
from inference.decay import has_decay
from inference.fit import minimised, split
from inference.levenberg_marquardt import Minimum
from inference.trajectory import PARAMETER_DIFFERENCE, RAN_AWAY, Problem
from inference.whitened_fit import whitened

# Times the step of the problem. With 2 and with 4, the evidence of 14 hypotheses of a recording agreed to 0.2 nats.
COARSER, IN_A_DECAY = 4.0, 2.0
COARSEST = 1.0 / 150.0  # s: no coarser step than that with which fits begin
SETTLED = 0.02  # nats: half the square of a correction's change, below which the fit needs no other one


@dataclass(frozen=True)
class Effort:
    """How far a fit goes: until a round lowers its sum of squares by less than this share, or so many rounds; and again
    after each of so many corrections, until these change no more.
    """

    tolerance: float
    rounds: int = 40
    passes: int = 4


def coarser(problem: Problem) -> float:
    """How much coarser the step of derivatives may be: less in a decay, whose phase runs away with the step's error."""
    return max(1.0, min(IN_A_DECAY if has_decay(problem) else COARSER, COARSEST / problem.step))


def corrected(problem: Problem, unknowns: Array) -> Problem:
    """The problem at a coarser step, with the residuals of its own step at these unknowns (P,).

    As it is where the coarser run leaves all bounds, there or as near as derivatives are taken. Three runs take the
    time of one (inference.levenberg_marquardt).
    """
    coarse = replace(problem, step=coarser(problem) * problem.step)
    if coarse.step == problem.step:
        return problem
    low, high = problem.bounds()
    moved = np.array([0.0, 1.0, -1.0]) * PARAMETER_DIFFERENCE * problem.scales()[:, None]
    rough = coarse.residuals(np.clip(unknowns[:, None] + moved, low[:, None], high[:, None]))[1]
    if max(float(np.abs(rows).max()) for rows in rough) >= RAN_AWAY:
        return problem
    exact = problem.residuals(unknowns[:, None])[1]
    return replace(coarse, defect=tuple(a[:, :, 0] - b[:, :, 0] for a, b in zip(exact, rough, strict=True)))


def minimised_at_step(problem: Problem, nuisances: tuple[Array, ...], effort: Effort) -> tuple[Array, Minimum, Problem]:
    """`inference.trajectory.minimised` with runs at the coarser step, and the problem that is corrected at its end.

    Where the step's error does not change slowly, a correction may lead uphill. Then the fit goes on from there with
    the step that the problem asks for, and so do its derivatives.
    """
    here = np.concatenate([problem.parameters[problem.rows()], *nuisances])
    coarse, passes = corrected(problem, here), 0
    cost = _cost(coarse, here)
    while True:
        unknowns, lowest = minimised(coarse, nuisances, tolerance=effort.tolerance, most=effort.rounds)
        there = replace(problem, parameters=split(problem, unknowns)[0])
        before, coarse = coarse, corrected(there, unknowns)
        reached = _cost(coarse, unknowns)
        if reached > cost + SETTLED:
            return *minimised(problem, nuisances, tolerance=effort.tolerance, most=effort.rounds), problem
        problem, nuisances, cost = there, split(problem, unknowns)[1], reached
        passes += 1
        if _change(before, coarse) < SETTLED or passes == effort.passes:
            return unknowns, lowest, coarse


def _cost(problem: Problem, unknowns: Array) -> float:
    """Half the sum of squares [nats] at these unknowns (P,)."""
    return 0.5 * float(np.sum(problem.residuals(unknowns[:, None])[0] ** 2))


def _change(before: Problem, after: Problem) -> float:
    """Half the square [nats] of the whitened change from one correction to the next."""
    if not before.defect or not after.defect:
        return 0.0 if before.step == after.step else np.inf
    change = [(b - a)[:, :, None] for a, b in zip(before.defect, after.defect, strict=True)]
    return 0.5 * float(np.sum(whitened(after, change, after.filters) ** 2))
