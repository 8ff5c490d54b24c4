"""Intervals by the bootstrap: the fit is repeated on its own residuals, drawn again in blocks of frames.

Blocks keep the residuals' correlation in time, which the fit's covariance does not see. All replicates are simulated in
one batch. Gauss-Newton steps with the fit's Jacobian bring each to its minimum; so near to the fit the Jacobian is
nearly exact. Source: Efron 1979; moving blocks, Kuensch 1989.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from affine_model.curvature import Array
from inference.fit import Fit
from inference.trajectory import ParameterName, Problem
from tentacle.solver_result import RESULTS

BLOCK_SECONDS = 1.0  # longer than the correlation time of a tracker's errors
ROUNDS = 4
SETTLED = 0.05  # of a parameter's spread: a last step that is smaller moves no end of an interval visibly


@dataclass(frozen=True)
class Bootstrap:
    """values (F, N) of the replicates; low and high (F,): the ends of the interval; result: how the replicates' fits
    ended.
    """

    free: tuple[ParameterName, ...]
    values: Array
    low: Array
    high: Array
    result: RESULTS


def _drawn(problem: Problem, fitted: Fit, random: np.random.Generator) -> Array:
    """Residuals (N,) as the fit orders them: used frames drawn again in blocks, priors drawn anew."""
    parts = []
    for experiment, residuals, nuisances in zip(problem.experiments, fitted.residuals, fitted.nuisances, strict=True):
        frames = residuals[experiment.used]
        t = experiment.observation.t[experiment.used]
        spacing = float(np.median(np.diff(t))) if t.size > 1 else BLOCK_SECONDS
        block = min(max(1, round(BLOCK_SECONDS / spacing)), t.size)
        starts = random.integers(0, t.size - block + 1, size=-(-t.size // block))
        index = (starts[:, None] + np.arange(block)).ravel()[: t.size]
        parts.append((frames[index] - frames.mean(axis=0)).ravel())
        order, length = problem.arm.order, problem.arm.specimen.length
        parts.append(random.normal(size=experiment.prior_residuals(order, length, nuisances[:, None]).shape[0]))
    drawn = np.concatenate(parts)
    return np.concatenate([drawn, random.normal(size=fitted.used_residuals.size - drawn.size)])


def bootstrap(problem: Problem, fitted: Fit, *, replicates: int = 200, seed: int = 0, share: float = 0.95) -> Bootstrap:
    """Central intervals of that share for the fitted parameters. The same seed gives the same intervals.

    ValueError where there are fewer than 20 replicates.
    """
    if replicates < 20:
        raise ValueError(f"{replicates} replicates; an interval needs at least 20")
    random = np.random.default_rng(seed)
    target = np.stack([_drawn(problem, fitted, random) for _ in range(replicates)], axis=1)
    target -= fitted.used_residuals[:, None]
    low, high = problem.bounds()
    unknowns = np.repeat(np.concatenate([fitted.values, *fitted.nuisances])[:, None], replicates, axis=1)
    size = np.maximum(np.linalg.norm(fitted.jacobian, axis=0), 1e-300)
    inverse = np.linalg.pinv(fitted.jacobian / size) / size[:, None]
    count, before = len(fitted.free), unknowns
    for _ in range(ROUNDS):
        before = unknowns
        unknowns = unknowns - inverse @ (problem.residuals(unknowns)[0] + target)
        unknowns = np.clip(unknowns, low[:, None], high[:, None])
    values = unknowns[:count]
    last = np.sqrt(np.mean((values - before[:count]) ** 2, axis=1))
    settled = bool(np.all(last <= SETTLED * np.std(values, axis=1)))
    tail = 50.0 * (1.0 - share)
    ends = np.percentile(values, [tail, 100.0 - tail], axis=1)
    return Bootstrap(fitted.free, values, ends[0], ends[1], RESULTS.CONVERGED if settled else RESULTS.MAX_STEPS)
