"""A fit of the declared model, judged by the adequacy gates, and its estimates with their intervals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from affine_model.arm import parameter_rows
from affine_model.curvature import Array
from inference.adequacy import Adequacy, adequacy
from inference.declared_arm import DECLARED
from inference.trajectory import Fit, Problem
from tentacle.model import Estimate


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


def parameter_interval(judged: JudgedFit, index: int, inflation: float) -> tuple[float, float]:
    """95 % interval of one free parameter, widened by the inflation and cut at the physical bounds."""
    spread: Array = np.sqrt(np.maximum(np.diag(judged.fitted.covariance), 0.0))
    half = 1.96 * float(spread[index]) * np.sqrt(inflation)
    low, high = (limit[index] for limit in judged.problem.bounds())
    value = float(judged.fitted.values[index])
    return max(low, value - half), min(high, value + half)


def estimates(judged: JudgedFit, inflation: float) -> dict[str, dict[str, Estimate]]:
    """All fitted parameters with their 95 % intervals, as a Model takes them."""
    units = {(row.effect, row.parameter.name): row.parameter.unit for row in parameter_rows()}
    table: dict[str, dict[str, Estimate]] = {}
    for index, (effect, name) in enumerate(judged.problem.free):
        if effect == DECLARED:
            continue
        low, high = parameter_interval(judged, index, inflation)
        value = float(judged.fitted.values[index])
        table.setdefault(effect, {})[name] = Estimate(value, low, high, units[effect, name])
    return table
