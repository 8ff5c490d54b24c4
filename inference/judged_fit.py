"""A fit of the declared model, judged by the adequacy gates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from inference.adequacy import Adequacy, adequacy
from inference.fit import Fit
from inference.trajectory import Problem


@dataclass(frozen=True)
class JudgedFit:
    """A problem, its fit, and whether the fit is adequate on the frames that were fitted."""

    problem: Problem
    fitted: Fit
    train: Adequacy


def judged_fit(problem: Problem, fitted: Fit) -> JudgedFit:
    """Judge a fit."""
    return JudgedFit(problem, fitted, adequacy(problem, fitted))


def variance_inflation(judged: JudgedFit) -> float:
    """Factor by which nats overstate the evidence.

    It is the variance of the residual over that of the noise, times the residual's correlation time in frames: 1 for
    white noise of the stated size. It widens ties and intervals if the model is not complete.
    """
    values, weights = [], []
    for experiment, residuals in zip(judged.problem.experiments, judged.fitted.residuals, strict=True):
        rows = residuals[experiment.used]
        rows = rows[:, np.any(rows != 0.0, axis=0)]
        if rows.shape[0] < 40:
            continue
        centred = rows - rows.mean(axis=0)
        power = np.mean(centred**2, axis=0)
        time = np.ones(rows.shape[1])
        for lag in range(1, min(200, rows.shape[0] // 3)):
            rho = np.mean(centred[lag:] * centred[:-lag], axis=0) / np.maximum(power, 1e-300)
            alive = rho > 0.1
            if not alive.any():
                break
            time += 2.0 * np.where(alive, rho, 0.0)
        values.append(np.mean(rows**2, axis=0) * np.where(np.mean(rows**2, axis=0) > 1.3, time, 1.0))
        weights.append(rows.shape[0])
    if not values:
        return 1.0
    return float(max(1.0, np.average([np.mean(value) for value in values], weights=weights)))
