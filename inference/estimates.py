"""The fitted parameters with their 95 % intervals, and how they vary together.

interval = value +- 1.96 sqrt(inflation covariance_kk), cut at the physical bounds
posterior = N(values, inflation covariance)
declared: covariance^-1 -> (covariance^-1 - T prior^-1) / inflation + prior^-1

Declared numbers have a prior. It does not depend on the data's errors, so that it is not inflated. T: the weight that
it has in the fit already (inference.experiment).
"""

from __future__ import annotations

import numpy as np

from affine_model.arm import parameter_rows
from inference.declared_arm import DECLARED, names_of
from inference.fit import Fit
from inference.trajectory import ParameterName, Problem
from tentacle.model import Estimate
from tentacle.posterior import Posterior


def interval(problem: Problem, fitted: Fit, name: ParameterName, inflation: float = 1.0) -> tuple[float, float]:
    """95 % interval of a free parameter, all that is possible where the data do not determine it. inflation: the factor
    by which the fit's variance is too small.
    """
    place = problem.free.index(name)
    half = 1.96 * float(np.sqrt(inflation * max(fitted.covariance[place, place], 0.0)))
    low, high = (float(limit[place]) for limit in problem.bounds())
    if name in fitted.undetermined:
        return low, high
    value = float(fitted.values[place])
    return max(low, value - half), min(high, value + half)


def joint_posterior(problem: Problem, fitted: Fit, inflation: float = 1.0) -> Posterior | None:
    """The joint normal of the fitted parameters that the data determine, declared quantities and nuisances
    marginalised; not cut at the bounds.
    """
    own = [k for k, name in enumerate(problem.free) if name[0] != DECLARED and name not in fitted.undetermined]
    names = tuple(".".join(problem.free[k]) for k in own)
    return Posterior.of_covariance(names, inflation * fitted.covariance[np.ix_(own, own)])


def declared_deviations(problem: Problem, fitted: Fit, inflation: float = 1.0) -> dict[str, float]:
    """Standard deviation of each uncertain declared number that is fitted, all else marginalised, by its name.
    inflation: the factor by which the fit's variance from the data is too small.
    """
    stated = zip(names_of(problem.declared), problem.declared, strict=True)
    fitted_at = {fitted.free.index(name): number for name, number in stated if name in fitted.free}
    if not fitted_at:
        return {}
    places, numbers = list(fitted_at), list(fitted_at.values())
    unit = np.array([number.spread for number in numbers])
    prior = np.diag([0.0 if number.sd is None else 1.0 for number in numbers])
    weight = problem.coarsening
    information = np.linalg.pinv(fitted.covariance[np.ix_(places, places)] / np.outer(unit, unit), hermitian=True)
    coarse = np.linalg.pinv((information - weight * prior) / inflation + prior, hermitian=True)
    deviations = unit * np.sqrt(np.maximum(np.diag(coarse), 0.0))
    return {number.name: float(sd) for number, sd in zip(numbers, deviations, strict=True)}


def estimates(problem: Problem, fitted: Fit, inflation: float = 1.0) -> dict[str, dict[str, Estimate]]:
    """All fitted parameters with their intervals, as a Model takes them: effect -> parameter -> estimate."""
    units = {(row.effect, row.parameter.name): row.parameter.unit for row in parameter_rows()}
    table: dict[str, dict[str, Estimate]] = {}
    for place, (effect, name) in enumerate(problem.free):
        if effect == DECLARED:
            continue
        low, high = interval(problem, fitted, (effect, name), inflation)
        table.setdefault(effect, {})[name] = Estimate(float(fitted.values[place]), low, high, units[effect, name])
    return table
