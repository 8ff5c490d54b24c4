"""Many arms that the data allow: samples of a model's parameters, so that a gait is chosen for all of them, not for
their mean.

    parameters ~ N(estimates, D R D) where the model carries its posterior (tentacle.posterior)
    parameter_k ~ N(estimate_k, (high - low)^2 / 3.92^2) of those that it does not cover, each by itself
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from affine_model.arm import parameter_index, parameter_rows, parameter_vector
from affine_model.curvature import Array
from affine_model.swim.objectives import Objective
from affine_model.swim.trial import GaitTrial, run
from tentacle.errors import InputError
from tentacle.model import Model

_INTERVAL = 2.0 * 1.959963984540054  # standard deviations across a 95 % interval


def drawn_from(model: Model) -> str:
    """From what the samples are drawn, in words."""
    varied = _with_interval(model)
    joint = 0 if model.posterior is None else len(set(model.posterior.names) & varied.keys())
    if joint < len(varied):
        alone = f"{len(varied) - joint} intervals, each by itself"
        return alone if not joint else f"the joint posterior of {joint} parameters and {alone}"
    return f"the joint posterior of {joint} parameters"


def parameter_samples(model: Model, count: int, seed: int) -> Array:
    """Parameters (R, count): the first column the estimates themselves, the others drawn from the model's posterior.

    A parameter that the posterior does not cover is normal within its 95 % interval, by itself. Values are kept within
    the parameter's bounds. Raises InputError where no parameter has an interval, since then there is nothing to be
    robust against.
    """
    samples = np.repeat(parameter_vector(model)[:, None], count, axis=1)
    bounds = {f"{row.effect}.{row.parameter.name}": row.parameter.bounds for row in parameter_rows()}
    random, varied = np.random.default_rng(seed), _with_interval(model)
    if not varied:
        raise InputError("no parameter has an interval", field="model.parameters", expected="low < high somewhere")
    joint = None if model.posterior is None else model.posterior.of(varied)
    departures: dict[str, Array] = {}
    if joint is not None:
        departures |= dict(zip(joint.names, joint.draws(count - 1, random), strict=True))
    for name, deviation in varied.items():
        departure = departures[name] if name in departures else deviation * random.standard_normal(count - 1)
        row = parameter_index(*name.split("."))
        samples[row, 1:] = np.clip(samples[row, 1:] + departure, *bounds[name])
    return samples


def _with_interval(model: Model) -> dict[str, float]:
    """Of every parameter with an interval its standard deviation, if it is normal within it."""
    every = (
        (f"{effect}.{name}", e) for effect, own in sorted(model.parameters.items()) for name, e in sorted(own.items())
    )
    return {name: (e.high - e.low) / _INTERVAL for name, e in every if e.high > e.low}


def robust_trial(trial: GaitTrial, model: Model, count: int, seed: int) -> GaitTrial:
    """The trial on `count` samples; scores are then the mean over the worst quarter of them."""
    return replace(trial, parameters=parameter_samples(model, count, seed))


def promised_interval(
    trial: GaitTrial, model: Model, objective: Objective, alpha: Array, samples: tuple[int, int] = (200, 1)
) -> tuple[float, float]:
    """95 % interval of the objective's quantity of one gait (9,) over samples (their number, seed) of the model.

    trial: a fine one, as the objective needs it.
    """
    outcome = run(robust_trial(trial, model, *samples), alpha[:, None])
    values = objective.quantity(outcome)[0]
    low, high = np.quantile(values[np.isfinite(values)], [0.025, 0.975])
    return float(low), float(high)
