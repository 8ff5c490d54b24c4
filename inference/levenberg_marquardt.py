"""Least squares within bounds by Levenberg-Marquardt, with several dampings at once: residuals are cheap in batches.

The kernel simulates eight individuals in the time of one. Therefore each round tries a ladder of dampings in one
batch and takes the best. A fit then takes about half the rounds of a trust region that tries one step at a time.
Individuals whose declared numbers differ are simulated one by one, so that fewer dampings are tried with those.
Source: Marquardt 1963; active bounds as in Bertsekas 1982 (projected Newton).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from affine_model.curvature import Array
from tentacle.solver_result import RESULTS

LADDER = 10.0 ** np.arange(-3.0, 5.0)  # dampings tried, times the current one
SHORT_LADDER = 10.0 ** np.array([-2.0, 0.0, 2.0])  # the same where each costs a run of its own; chosen, for speed
SMALLEST, LARGEST = 1e-9, 1e9
HELD_ROUNDS = 4  # of holding unknowns at their bounds in one step
FLAT = 1e-14  # reciprocal condition number below which rounding decides the step: about 50 units of double precision


@dataclass(frozen=True)
class Minimum:
    """Where the search ended: unknowns (P,), rounds taken, how it ended, and half the sum of squares there."""

    unknowns: Array
    rounds: int
    result: RESULTS
    cost: float


@dataclass(frozen=True)
class Rounds:
    """How many rounds at most, and the dampings (D,) that each tries at once, a geometric sequence; if all are refused,
    its next D members.
    """

    most: int
    dampings: Array = field(default_factory=lambda: LADDER)


def minimise(
    residuals: Callable[[Array], Array],
    jacobian: Callable[[Array, Array | None], tuple[Array, Array]],
    start: Array,
    bounds: tuple[Array, Array],
    *,
    tolerance: float,
    rounds: Rounds,
) -> Minimum:
    """Minimise 1/2 |r(x)|^2 over low <= x <= high.

    residuals maps (P, B) to (N, B). jacobian takes x (P,) and the residuals there (N,), if they are known, to these
    residuals and their derivatives (N, P). x is scaled so that its natural steps are about 1. It converges when a round
    lowers the sum by less than `tolerance` of itself; after `rounds.most` rounds it ends with RESULTS.MAX_STEPS.
    """
    dampings = rounds.dampings
    beyond = dampings[-1] * dampings[1] / dampings[0] ** 2
    low, high = bounds
    x, damping = np.clip(start, low, high), 1e-3
    value, slope = jacobian(x, None)
    cost = 0.5 * float(value @ value)
    for round_number in range(rounds.most):
        gradient, curvature = slope.T @ value, slope.T @ slope
        # A variable on its bound that wants to leave the box stays where it is in this round.
        free = ~(((x <= low) & (gradient > 0.0)) | ((x >= high) & (gradient < 0.0)))
        if not free.any():
            return Minimum(x, round_number, RESULTS.AT_BOUND, cost)
        for rungs in (damping * dampings, beyond * damping * dampings):
            ladder = np.clip(rungs, SMALLEST, LARGEST)
            trials = np.repeat(x[:, None], ladder.size, axis=1)
            room = low[free] - x[free], high[free] - x[free]
            trials[free] += _steps(curvature[np.ix_(free, free)], gradient[free], ladder, room)
            trials = np.clip(trials, low[:, None], high[:, None])
            values = residuals(trials)
            costs = 0.5 * np.einsum("nb,nb->b", values, values)
            best = int(np.argmin(costs))
            if costs[best] < cost:
                break
        else:
            return Minimum(x, round_number, _ending(curvature, free), cost)
        gained = cost - costs[best]
        x, cost, damping = trials[:, best], float(costs[best]), float(ladder[best])
        if gained <= tolerance * cost:
            return Minimum(x, round_number + 1, _ending(curvature, free), cost)
        value, slope = jacobian(x, values[:, best])
    return Minimum(x, rounds.most, RESULTS.MAX_STEPS, cost)


def _ending(curvature: Array, free: np.ndarray) -> RESULTS:
    """The result code of a converged search. curvature (P, P): of the last round; free (P,): not held by a bound."""
    kept = curvature[np.ix_(free, free)]
    size = np.sqrt(np.maximum(np.diag(kept), 1e-300))
    values = np.linalg.eigvalsh(kept / np.outer(size, size))
    if values[0] <= FLAT * values[-1]:
        return RESULTS.SINGULAR
    return RESULTS.CONVERGED if free.all() else RESULTS.AT_BOUND


def _steps(curvature: Array, gradient: Array, ladder: Array, room: tuple[Array, Array]) -> Array:
    """Damped Gauss-Newton steps (F, B), one for each damping, by one eigendecomposition in the diagonal's scale.

    room: the lowest and the highest step of each unknown. If a step leaves it, those unknowns go to their bound, and
    the others are solved again.
    """
    size = np.sqrt(np.maximum(np.diag(curvature), 1e-300))
    scaled = curvature / np.outer(size, size)
    values, vectors = np.linalg.eigh(scaled)
    turned = vectors.T @ (gradient / size)
    steps = -(vectors @ (turned[:, None] / (np.maximum(values, 0.0)[:, None] + ladder[None, :])))
    low, high = (limit * size for limit in room)
    for k, damping in enumerate(ladder):
        step, held = steps[:, k], np.zeros(size.size, dtype=bool)
        for _ in range(HELD_ROUNDS):
            leaving = ~held & ((step < low) | (step > high))
            if not leaving.any():
                break
            held |= leaving
            step = np.clip(step, low, high)
            free = ~held
            matrix = scaled[np.ix_(free, free)] + damping * np.eye(int(free.sum()))
            slope = (gradient / size)[free] + scaled[np.ix_(free, held)] @ step[held]
            step[free] = -np.linalg.solve(matrix, slope)
        steps[:, k] = step
    return steps / size[:, None]
