"""Many arms that the data allow: samples of a model's parameters, so that a gait is chosen for all of them, not for
their mean.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from affine_model.arm import parameter_index, parameter_rows, parameter_vector
from affine_model.curvature import Array
from affine_model.swim.trial import GaitTrial
from tentacle.errors import InputError
from tentacle.model import Model

_INTERVAL = 2.0 * 1.959963984540054  # standard deviations across a 95 % interval


def parameter_samples(model: Model, count: int, seed: int) -> Array:
    """Parameters (R, count): the first column the estimates themselves, the others normal within each 95 % interval.

    Values are kept within the parameter's bounds. Estimates are taken as independent: a Model states no correlations.
    Raises InputError where no parameter has an interval, since then there is nothing to be robust against.
    """
    values = parameter_vector(model)
    bounds = {(row.effect, row.parameter.name): row.parameter.bounds for row in parameter_rows()}
    samples = np.repeat(values[:, None], count, axis=1)
    random = np.random.default_rng(seed)
    uncertain = 0
    for effect, parameters in sorted(model.parameters.items()):
        for name, estimate in sorted(parameters.items()):
            if not estimate.high > estimate.low:
                continue
            low, high = bounds[(effect, name)]
            deviation = (estimate.high - estimate.low) / _INTERVAL
            drawn = np.clip(estimate.value + deviation * random.standard_normal(count - 1), low, high)
            samples[parameter_index(effect, name), 1:] = drawn
            uncertain += 1
    if not uncertain:
        raise InputError("no parameter has an interval", field="model.parameters", expected="low < high somewhere")
    return samples


def robust_trial(trial: GaitTrial, model: Model, count: int, seed: int) -> GaitTrial:
    """The trial on `count` samples; scores are then the mean over the worst quarter of them."""
    return replace(trial, parameters=parameter_samples(model, count, seed))
