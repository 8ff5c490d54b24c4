"""How well the data know the parameters: condition, what is pinned, channels that say nothing, the clock."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from affine_model.arm import parameter_index, parameter_rows
from affine_model.curvature import Array
from inference.trajectory import DIFFERENCE, Fit, ParameterName, Problem

DEAD = 1e-6  # of the strongest channel's sensitivity: below, a channel is blind to every parameter
CLOCK = ("time_offset", "offset")


@dataclass(frozen=True)
class Identifiability:
    """What a fit's data can tell.

    condition: of the parameters' information, each in units of its own standard error, all else marginalised (1: every
    parameter is seen by itself; 1e4: one combination is known 100 times worse). weakest: that combination, as shares
    (F,) of unit length in the same units. at_bound: parameters pinned at a bound. dead: of every recording, the
    places of the observation's channels that say nothing: never seen, or moved by no parameter. clock (offset [s],
    standard error [s]): by how much the motor's clock would have to move for the best fit, to first order; NaN where
    the clock is among the fitted parameters.
    """

    condition: float
    weakest: Array
    at_bound: tuple[ParameterName, ...]
    dead: tuple[tuple[int, ...], ...]
    clock: tuple[float, float]


def identifiability(problem: Problem, fitted: Fit) -> Identifiability:
    """Judge a finished fit; it costs two simulations of every recording."""
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
    """Places of the channels of each recording whose rows of the Jacobian vanish, parameters' columns alone."""
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
    """Gauss-Newton's step in the clock's offset from the fitted model, with its standard error."""
    if CLOCK in fitted.free or not problem.experiments:
        return np.nan, np.nan
    row = parameter_index(*CLOCK)
    nominal = next(r.parameter.nominal for r in parameter_rows() if r.index == row)
    moved = np.repeat(fitted.parameters[:, None], 2, axis=1)
    moved[row] += np.array([1.0, -1.0]) * DIFFERENCE * nominal
    unknowns = np.concatenate([fitted.values, *fitted.nuisances])
    values = problem.residuals_of(moved, np.repeat(unknowns[:, None], 2, axis=1))
    column = (values[:, 0] - values[:, 1]) / (2.0 * DIFFERENCE * nominal)
    size = np.maximum(np.linalg.norm(fitted.jacobian, axis=0), 1e-300)
    own = column - fitted.jacobian / size @ np.linalg.lstsq(fitted.jacobian / size, column, rcond=None)[0]
    information = float(own @ own)
    if information <= DEAD * float(column @ column):
        return 0.0, np.inf
    return float(-(own @ fitted.used_residuals) / information), float(information**-0.5)
