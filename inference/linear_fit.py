"""Least squares in parameters on which a residual depends linearly: the pseudo-inverse of eq. 19."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from affine_model.arm import parameter_rows
from affine_model.curvature import Array

ParameterName = tuple[str, str]  # effect, parameter


@dataclass(frozen=True)
class LinearFit:
    """free: names of the fitted parameters; values (F,); covariance (F, F), from the residual's own scatter;
    parameters (R,) the whole vector; condition of the scaled columns (1: each parameter is seen by itself);
    residual (N,) after the fit.
    """

    free: tuple[ParameterName, ...]
    values: Array
    covariance: Array
    parameters: Array
    condition: float
    residual: Array


def linear_columns(
    residual: Callable[[Array], Array], parameters: Array, free: Sequence[ParameterName]
) -> tuple[Array, Array]:
    """The residual (N,) at the given parameters, and a column (N, F) for each free one: by differencing one parameter
    at a time, by its nominal size.
    """
    rows = {(row.effect, row.parameter.name): row for row in parameter_rows()}
    at_given = residual(parameters)
    columns = []
    for name in free:
        moved = parameters.copy()
        moved[rows[name].index] += rows[name].parameter.nominal
        columns.append((residual(moved) - at_given) / rows[name].parameter.nominal)
    return at_given, np.stack(columns, axis=1)


def fit_linear(
    residual: Callable[[Array], Array], parameters: Array, free: Sequence[ParameterName], *, independent: float = 1.0
) -> LinearFit:
    """Solve residual(parameters) = 0 for the free parameters in the least-squares sense, the others as given.

    residual maps a vector (R,) to (N,). Its columns are taken by differencing (linear_columns): exact where the
    dependence is linear (k, d, C_perp, C_a, masses ...), elsewhere a local linearisation about the given vector.
    independent: share of the N rows that count as independent of one another, for the covariance.
    """
    rows = {(row.effect, row.parameter.name): row for row in parameter_rows()}
    at_given, Y = linear_columns(residual, parameters, free)
    size = np.maximum(np.linalg.norm(Y, axis=0), 1e-300)
    inverse = np.linalg.pinv(Y / size)
    change = -(inverse @ at_given) / size  # eq. 19
    left = at_given + Y @ change
    freedom = max(independent * left.size - len(free), 1.0)
    covariance = (inverse @ inverse.T) / np.outer(size, size) * (left @ left) * independent / freedom / independent
    values = parameters.copy()
    values[[rows[name].index for name in free]] += change
    return LinearFit(
        tuple(free), values[[rows[name].index for name in free]], covariance, values,
        float(np.linalg.cond(Y / size)), left,
    )  # fmt: skip
