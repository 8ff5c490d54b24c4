"""A quasi-Newton ascent from the best gait found.

By default the gradient comes from one batch of the kernel: all 18 neighbours of a point at once. It costs about as much
as one generation and is right to about 1e-3. The exact gradient (affine_model.swim.exact_gradient) is right to 1e-6 and
costs some hundred times as much.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from affine_model.curvature import Array
from affine_model.swim.limits import Box
from affine_model.swim.objectives import Objective, gait_scores
from affine_model.swim.trial import GaitTrial, run
from tentacle.solver_result import RESULTS

Slope = Callable[[GaitTrial, Objective, Box, Array], tuple[float, Array]]  # of a point (9,): score and gradient (9,)
_OFFSET = 1e-4  # of the unit cube: truncation ~ offset^2, rounding ~ 1e-13 / offset


@dataclass(frozen=True)
class Polished:
    """The best point (9,) of the unit cube that a climb met, its score, and how the climb ended."""

    point: Array
    score: float
    result: RESULTS


def value_and_gradient(
    trial: GaitTrial, objective: Objective, box: Box, unit: Array, offset: float = _OFFSET
) -> tuple[float, Array]:
    """Score of a point (9,) of the unit cube and its gradient (9,) by central differences, one-sided at the walls."""
    size = len(unit)
    steps = offset * np.eye(size)
    around = unit[:, None] + np.concatenate([np.zeros((size, 1)), steps, -steps], axis=1)
    around[:6] = np.clip(around[:6], 0.0, 1.0)
    values = gait_scores(objective, trial, run(trial, box.alpha(around)))
    ahead, behind = around[:, 1 : size + 1], around[:, size + 1 :]
    widths = np.diag(ahead) - np.diag(behind)
    return float(values[0]), (values[1 : size + 1] - values[size + 1 :]) / widths


def polish(
    trial: GaitTrial,
    objective: Objective,
    box: Box,
    unit: Array,
    evaluations: int = 30,
    slope: Slope = value_and_gradient,
) -> Polished:
    """Climb from a point (9,), never to a worse one (L-BFGS-B, Byrd et al. 1995)."""
    scale = max(abs(float(gait_scores(objective, trial, run(trial, box.alpha(unit[:, None])))[0])), 1e-12)
    best: list[tuple[float, Array]] = []

    def falling(point: Array) -> tuple[float, Array]:
        value, gradient = slope(trial, objective, box, point)
        best.append((value, point.copy()))
        return -value / scale, -gradient / scale

    bounds = [(0.0, 1.0)] * 6 + [(None, None)] * 3
    inside = np.concatenate([np.clip(unit[:6], 0.0, 1.0), unit[6:]])
    ended = minimize(falling, inside, jac=True, method="L-BFGS-B", bounds=bounds, options={"maxfun": evaluations})
    value, point = max(best, key=lambda pair: pair[0])
    return Polished(point, value, RESULTS.CONVERGED if ended.success else RESULTS.MAX_STEPS)
