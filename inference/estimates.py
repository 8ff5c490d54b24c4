"""The fitted parameters with their 95 % intervals, and how they vary together.

interval = value +- 1.96 sqrt(inflation covariance_kk), cut at the physical bounds
posterior = N(values, inflation covariance)
"""

from __future__ import annotations

import numpy as np

from affine_model.arm import parameter_rows
from inference.declared_arm import DECLARED
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
