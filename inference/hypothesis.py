"""A hypothesis of the rules: the declared model with some absent effects, fitted and judged by the adequacy gates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from affine_model.arm import parameter_rows
from affine_model.curvature import Array
from affine_model.effects import catalogue
from inference.adequacy import ALLOWANCE, MATERIAL, Adequacy, adequacy
from inference.declared_arm import DECLARED
from inference.trajectory import Fit, Problem
from tentacle.model import Estimate

# Half the upper 1e-4 quantile of chi-square(1): a likelihood-ratio test at .01 over 100 variants (Wilks 1938).
NATS_PER_PARAMETER = 7.6


@dataclass(frozen=True)
class GatedHypothesis:
    """A model with some absent effects, refitted and judged.

    penalised_log_likelihood [nats]: of fitted and held-out frames, minus a penalty for each parameter. reduction: the
    error of the reduced model on fitted and on held-out frames. laws: the error of the added laws there, as no law is
    known exactly. Both are rms in noise sigmas, and neither counts as missing physics.
    """

    effects: tuple[str, ...]
    problem: Problem
    fitted: Fit
    penalised_log_likelihood: float
    train: Adequacy
    judged: Adequacy
    reduction: tuple[float, float] = (0.0, 0.0)
    laws: tuple[float, float] = (0.0, 0.0)

    @property
    def passed(self) -> bool:
        """Whether every gate was passed, on what was fitted and on what was held out."""
        return self.train.passed and self.judged.passed

    @property
    def misfit(self) -> float:
        """Half the sum of squared whitened residuals, fitted and held-out frames together [nats]."""
        return self.fitted.misfit + held_out_misfit(self.problem, self.fitted)

    @property
    def excess_rms(self) -> float:
        """rms of the residual beyond noise, on fitted or on held-out frames, whichever is larger [noise sigmas]."""
        return max(self.train.structure, self.judged.structure)

    def laws_with(self, effect: str) -> tuple[float, float]:
        """The error of the laws once this effect is added too: a share of the structure without it."""
        share = catalogue()[effect].law_error
        more = share * self.train.structure, share * self.judged.structure
        return float(np.hypot(self.laws[0], more[0])), float(np.hypot(self.laws[1], more[1]))

    def discrepancy_in(self, problem: Problem) -> tuple[tuple[float, float], tuple[float, float]]:
        """reduction and laws in sigmas of another problem's noise; their millimetres stay the same."""
        ratio = noise_ratio(self.problem, problem)
        (fitted, held_out), laws = self.reduction, self.laws
        return (ratio * fitted, ratio * held_out), (ratio * laws[0], ratio * laws[1])


def noise_ratio(one: Problem, other: Problem) -> float:
    """How many times larger the first problem's noise is, rms over recordings and channels."""
    pairs = zip(one.experiments, other.experiments, strict=True)
    return float(np.sqrt(np.mean([np.mean((a.noise_gain / b.noise_gain) ** 2) for a, b in pairs])))


def against_baseline(h: GatedHypothesis) -> bool:
    """Whether the noise includes the residual of a baseline, which is correlated over many frames."""
    return any(experiment.correlation > 1.0 for experiment in h.problem.experiments)


def held_out_misfit(problem: Problem, fitted: Fit) -> float:
    """Half the sum of squared whitened residuals on the frames that were not fitted [nats]."""
    total = 0.0
    for experiment, residuals in zip(problem.experiments, fitted.residuals, strict=True):
        total += 0.5 * float(np.sum(residuals[~experiment.used] ** 2))
    return total


def nats_per_parameter(problem: Problem) -> float:
    """The penalty of a parameter [nats]. It grows with the noise's correlation time: each frame then tells less."""
    return NATS_PER_PARAMETER * max(experiment.correlation for experiment in problem.experiments)


def gated_hypothesis(
    effects: tuple[str, ...],
    problem: Problem,
    fitted: Fit,
    reduction: tuple[float, float] = (0.0, 0.0),
    laws: tuple[float, float] = (0.0, 0.0),
) -> GatedHypothesis:
    """Judge a fit. reduction, laws: as in GatedHypothesis."""
    parameters = sum(len(catalogue()[name].parameters) for name in effects)
    likelihood = -fitted.misfit - held_out_misfit(problem, fitted) - nats_per_parameter(problem) * parameters
    discrepancy_rms = np.hypot(ALLOWANCE * np.array(reduction), laws)
    train = adequacy(problem, fitted, held_out=False, discrepancy_rms=float(discrepancy_rms[0]))
    judged = adequacy(problem, fitted, held_out=True, discrepancy_rms=float(discrepancy_rms[1]))
    return GatedHypothesis(effects, problem, fitted, likelihood, train, judged, reduction, laws)


def material_gain(current: GatedHypothesis) -> float:
    """The smallest gain [nats] that counts as physics.

    It is the misfit, over all residuals, of MATERIAL noise sigmas with the errors of the reduction and of the laws.
    """
    structure = MATERIAL**2 + (ALLOWANCE * current.reduction[0]) ** 2 + current.laws[0] ** 2
    return 0.5 * structure * current.fitted.count


def variance_inflation(judged: GatedHypothesis) -> float:
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


def parameter_interval(judged: GatedHypothesis, index: int, inflation: float) -> tuple[float, float]:
    """95 % interval of one free parameter, widened by the inflation and cut at the physical bounds."""
    spread: Array = np.sqrt(np.maximum(np.diag(judged.fitted.covariance), 0.0))
    half = 1.96 * float(spread[index]) * np.sqrt(inflation)
    low, high = (limit[index] for limit in judged.problem.bounds())
    value = float(judged.fitted.values[index])
    return max(low, value - half), min(high, value + half)


def estimates(judged: GatedHypothesis, inflation: float) -> dict[str, dict[str, Estimate]]:
    """All fitted parameters of a hypothesis with their 95 % intervals, as a Model takes them."""
    units = {(row.effect, row.parameter.name): row.parameter.unit for row in parameter_rows()}
    table: dict[str, dict[str, Estimate]] = {}
    for index, (effect, name) in enumerate(judged.problem.free):
        if effect == DECLARED:
            continue
        low, high = parameter_interval(judged, index, inflation)
        value = float(judged.fitted.values[index])
        table.setdefault(effect, {})[name] = Estimate(value, low, high, units[effect, name])
    return table
