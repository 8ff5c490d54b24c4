"""How well the data determine the parameters: condition, parameters at a bound, silent channels, the clock."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from affine_model.arm import parameter_index, parameter_rows
from affine_model.curvature import Array
from inference.fit import Fit
from inference.trajectory import PARAMETER_DIFFERENCE, ParameterName, Problem

DEAD = 1e-6  # of the strongest channel's sensitivity: a weaker channel sees no parameter
CLOCK_PARAMETER = ("time_offset", "offset")


@dataclass(frozen=True)
class Identifiability:
    """What the data of a fit determine.

    condition: condition number of the estimates' correlation matrix (1: every parameter is seen by itself; 1e4: one
    combination is known 100 times worse). weakest: that combination, a unit vector (F,). at_bound: parameters at a
    bound. dead: for each recording the places of the channels that say nothing, as they were never seen or no parameter
    moves them. clock (offset [s], standard error [s]): the shift of the motor's clock that fits best, to first order;
    NaN if the clock is among the fitted parameters.
    """

    condition: float
    weakest: Array
    at_bound: tuple[ParameterName, ...]
    dead: tuple[tuple[int, ...], ...]
    clock: tuple[float, float]


def identifiability(problem: Problem, fitted: Fit) -> Identifiability:
    """Judge a finished fit. It takes two simulations of every recording."""
    spread = np.sqrt(np.maximum(np.diag(fitted.covariance), 1e-300))
    values, vectors = np.linalg.eigh(fitted.covariance / np.outer(spread, spread))
    return Identifiability(
        condition=float(values[-1] / max(values[0], 1e-300)) if values.size else 1.0,
        weakest=vectors[:, -1] if values.size else np.zeros(0),
        at_bound=fitted.at_bound,
        dead=_dead_channels(problem, fitted),
        clock=_clock(problem, fitted),
    )


def _dead_channels(problem: Problem, fitted: Fit) -> tuple[tuple[int, ...], ...]:
    """Places of the channels of each recording whose rows vanish in the parameters' columns of the Jacobian."""
    place, dead = 0, []
    for experiment, residuals, nuisances in zip(problem.experiments, fitted.residuals, fitted.nuisances, strict=True):
        frames, channels = int(experiment.used.sum()), residuals.shape[1]
        rows = fitted.jacobian[place : place + frames * channels, : len(fitted.free)]
        scaled = rows * problem.scales()[: len(fitted.free)]
        strength = np.linalg.norm(scaled.reshape(frames, channels, -1), axis=(0, 2))
        dead.append(tuple(np.flatnonzero(strength <= DEAD * max(strength.max(initial=0.0), 1e-300)).tolist()))
        order, length = problem.arm.order, problem.arm.specimen.length
        place += frames * channels + experiment.prior_residuals(order, length, nuisances[:, None]).shape[0]
    return tuple(dead)


def _clock(problem: Problem, fitted: Fit) -> tuple[float, float]:
    """The Gauss-Newton step in the clock's offset from the fitted model, with its standard error."""
    if CLOCK_PARAMETER in fitted.free or not problem.experiments:
        return np.nan, np.nan
    row = parameter_index(*CLOCK_PARAMETER)
    nominal = next(r.parameter.nominal for r in parameter_rows() if r.index == row)
    moved = np.repeat(fitted.parameters[:, None], 2, axis=1)
    moved[row] += np.array([1.0, -1.0]) * PARAMETER_DIFFERENCE * nominal
    unknowns = np.concatenate([fitted.values, *fitted.nuisances])
    values = problem.residuals_of(moved, np.repeat(unknowns[:, None], 2, axis=1))
    column = (values[:, 0] - values[:, 1]) / (2.0 * PARAMETER_DIFFERENCE * nominal)
    size = np.maximum(np.linalg.norm(fitted.jacobian, axis=0), 1e-300)
    own = column - fitted.jacobian / size @ np.linalg.lstsq(fitted.jacobian / size, column, rcond=None)[0]
    information = float(own @ own)
    if information <= DEAD * float(column @ column):
        return 0.0, np.inf
    return float(-(own @ fitted.used_residuals) / information), float(information**-0.5)
