"""The prior of the added effects' parameters, of what varies between recordings, and of what is declared.

    strength ~ Cauchy(0, |nominal|),       shape ~ uniform between its bounds (in its logarithm where they are positive)
    log (parameter in a recording / parameter) ~ N(0, spread^2),        declared number ~ N(value, sd^2)

The base parameters' and initial states' priors are those of every hypothesis, and are left out.
"""

from __future__ import annotations

import numpy as np

from affine_model.arm import parameter_rows
from affine_model.curvature import Array
from affine_model.effect import Parameter
from affine_model.effects import catalogue
from inference.declared_arm import DECLARED
from inference.experiment import MEMORY_PRIOR
from inference.fit import Fit
from inference.trajectory import Problem


def _added(problem: Problem) -> list[tuple[int, Parameter]]:
    """Places of the added effects' parameters among the free ones, with their catalogue entries."""
    known = {(row.effect, row.parameter.name): row.parameter for row in parameter_rows()}
    return [
        (place, known[name])
        for place, name in enumerate(problem.free)
        if name[0] != DECLARED and catalogue()[name[0]].family != "base"
    ]


def prior_precision(problem: Problem, fitted: Fit) -> Array:
    """Information (P,) of the prior of each unknown. It bounds unknowns that the data do not determine."""
    precision = np.zeros(len(problem.free) + sum(problem.sizes()))
    for place, parameter in _added(problem):
        low, high = parameter.bounds
        if parameter.scan:
            width = high - low if low <= 0.0 else float(fitted.values[place]) * np.log(high / low)
            precision[place] = 12.0 / width**2
        else:
            precision[place] = 1.0 / (100.0 * parameter.nominal) ** 2
    return precision


def log_prior(problem: Problem, fitted: Fit) -> float:
    """Log density of the added effects' parameters, and, at its mean, of what they bring, varies, or is declared."""
    total = 0.0
    for place, parameter in _added(problem):
        value, (low, high) = float(fitted.values[place]), parameter.bounds
        if not parameter.scan:
            sides = 1.0 if low < 0.0 else 2.0
            size = abs(parameter.nominal)
            total += np.log(sides / (np.pi * size * (1.0 + (value / size) ** 2)))
        elif low > 0.0:
            total -= np.log(value * np.log(high / low))
        else:
            total -= np.log(high - low)
    widths = [MEMORY_PRIOR for e in problem.experiments if e.begins_with_memory for _ in range(problem.arm.order)]
    stated = [n.sd / np.sqrt(problem.coarsening) for n in problem.declared if n.sd is not None]
    spreads = np.concatenate([widths, stated, *(e.spreads() for e in problem.experiments)])
    return float(total) - float(np.log(np.sqrt(2.0 * np.pi) * spreads).sum())


def laplace_evidence(problem: Problem, fitted: Fit, variance: float) -> float:
    """Log evidence [nats] of a model without unknown forces, by Laplace's method; variance: of its whitened noise.

    -inf where the method has no answer: the data and the priors leave a direction of the unknowns open.
    """
    scale = problem.scales()
    columns = fitted.jacobian * scale
    information = columns.T @ columns / variance + np.diag(prior_precision(problem, fitted) * scale**2)
    sign, log_determinant = np.linalg.slogdet(information)
    if sign <= 0.0 or not np.isfinite(log_determinant):
        return -np.inf
    constant = 0.5 * scale.size * np.log(2.0 * np.pi) + log_prior(problem, fitted) + np.log(scale).sum()
    return float(constant - fitted.misfit / variance - 0.5 * log_determinant)
