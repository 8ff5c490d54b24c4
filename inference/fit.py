"""The solution of a trajectory fit: least squares from one start, and the model with its derivatives there.

The minimum of |r|^2 / 2 of inference.trajectory by Levenberg and Marquardt's method; scipy's least_squares finds the
same minimum (a test compares).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from affine_model.curvature import Array
from inference.declared_arm import DECLARED
from inference.levenberg_marquardt import LADDER, SHORT_LADDER, Minimum, Rounds, minimise
from inference.linear_fit import ParameterName
from inference.trajectory import Problem
from tentacle.solver_result import RESULTS

# Of an unknown's square in directions that the data do not tell. Rounding turns the direction of an eigenvalue of 32
# times the limit of _inverse or more by (1/32)^2 of it at most (Davis and Kahan 1970). It decides over no verdict.
MOST_UNTOLD = 1e-3


@dataclass(frozen=True)
class Fit:
    """A fitted model.

    free: the fitted parameters; values, covariance of them alone, all else marginalised; parameters (R,) the whole
    vector; nuisances: one array a recording; misfit = 1/2 sum of squared whitened residuals on the used frames
    (nats); count: how many residuals that is; residuals: whitened (T, K) a recording, all frames; at_bound: names of
    parameters that ended on a bound; jacobian (N, P) and used_residuals (N,) for score tests; result: how the solver
    ended; slopes: d residuals / d unknowns (T, K, P) a recording, all frames; undetermined: names of parameters on
    which the residuals do not depend, alone or together with others.
    """

    free: tuple[ParameterName, ...]
    values: Array
    covariance: Array
    parameters: Array
    nuisances: tuple[Array, ...]
    misfit: float
    count: int
    residuals: tuple[Array, ...]
    at_bound: tuple[ParameterName, ...]
    jacobian: Array
    used_residuals: Array
    evaluations: int
    result: RESULTS = RESULTS.CONVERGED
    slopes: tuple[Array, ...] = ()
    undetermined: tuple[ParameterName, ...] = ()


def fit(problem: Problem, nuisances: tuple[Array, ...], *, tolerance: float = 1e-7, most: int = 40) -> Fit:
    """Fit from one start: the problem's parameters and the given nuisances.

    Raises ValueError where there is not one used frame.
    """
    unknowns, lowest = minimised(problem, nuisances, tolerance=tolerance, most=most)
    return replace(linearised_fit(problem, unknowns, lowest.rounds), result=lowest.result)


def minimised(problem: Problem, nuisances: tuple[Array, ...], *, tolerance: float, most: int) -> tuple[Array, Minimum]:
    """The unknowns (P,) at the minimum, and how the solver ended, without their covariance."""
    low, high = problem.bounds()
    scales = problem.scales()
    start = np.concatenate([problem.parameters[problem.rows()], *nuisances])
    start = np.clip(start, low, high)
    if not any(experiment.used.any() for experiment in problem.experiments):
        raise ValueError("no frame to fit")

    def slope(scaled: Array, value: Array | None) -> tuple[Array, Array]:
        value, slopes = problem.slope(scaled * scales, value)
        return value, slopes * scales

    lowest = minimise(
        lambda scaled: problem.residuals(scaled * scales[:, None])[0],
        slope,
        start / scales,
        (low / scales, high / scales),
        tolerance=tolerance,
        rounds=Rounds(most, SHORT_LADDER if any(table == DECLARED for table, _ in problem.free) else LADDER),
    )
    return lowest.unknowns * scales, lowest


def split(problem: Problem, unknowns: Array) -> tuple[Array, tuple[Array, ...]]:
    """Unknowns (P,) as the whole parameter vector and the nuisances of each recording."""
    parameters, count = problem.parameters.copy(), len(problem.free)
    parameters[problem.rows()] = unknowns[:count]
    return parameters, tuple(np.split(unknowns[count:], np.cumsum(problem.sizes())[:-1]))


def linearised_fit(problem: Problem, unknowns: Array, evaluations: int) -> Fit:
    """The model at these unknowns (P,), with its derivatives there and the covariance from them."""
    used, jacobian, everything, slopes = problem.linearised(unknowns)
    low, high = problem.bounds()
    count = len(problem.free)
    covariance, determined = _inverse(jacobian.T @ jacobian)
    values = unknowns[:count]
    close = 1e-6 * problem.scales()[:count]
    touching = (values <= low[:count] + close) | (values >= high[:count] - close)
    parameters, parts = split(problem, unknowns)
    return Fit(
        free=problem.free,
        values=values,
        covariance=covariance[:count, :count],
        parameters=parameters,
        nuisances=parts,
        misfit=0.5 * float(used @ used),
        count=used.shape[0],
        residuals=tuple(everything),
        at_bound=tuple(name for name, flag in zip(problem.free, touching, strict=True) if flag),
        jacobian=jacobian,
        used_residuals=used,
        evaluations=evaluations,
        slopes=tuple(slopes),
        undetermined=tuple(name for name, told in zip(problem.free, determined, strict=False) if not told),
    )


def _inverse(information: Array) -> tuple[Array, Array]:
    """The covariance (P, P) from an information matrix in the directions that the data determine, and whether they
    determine each unknown (P,): a direction that they do not has no variance here, but in truth any.
    """
    size = np.sqrt(np.maximum(np.diag(information), 1e-200))
    values, vectors = np.linalg.eigh(information / np.outer(size, size))
    told = values > values.size * np.finfo(float).eps * values[-1]
    covariance = (vectors[:, told] / values[told]) @ vectors[:, told].T / np.outer(size, size)
    return covariance, np.square(vectors[:, ~told]).sum(axis=1) < MOST_UNTOLD


def unfitted(problem: Problem, nuisances: tuple[Array, ...]) -> Fit:
    """The problem at its start, with its Jacobian, not fitted."""
    unknowns = np.concatenate([problem.parameters[problem.rows()], *nuisances])
    return linearised_fit(problem, unknowns, 0)
