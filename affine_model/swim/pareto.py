"""The front of speed against power: gaits that no other gait beats in both."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from affine_model.curvature import Array
from affine_model.swim.limits import Box
from affine_model.swim.objectives import weighted
from affine_model.swim.search import search
from affine_model.swim.trial import Trial

EXPONENTS = (
    0.0,
    0.25,
    0.4,
    0.55,
    0.7,
    0.85,
    1.0,
)  # of the power in speed / power^x, from the fastest gait to the cheapest


@dataclass(frozen=True)
class Front:
    """alpha (9, P), speed (P,) [m/s] and power (P,) [W], by rising speed."""

    alpha: Array
    speed: Array
    power: Array


def not_dominated(speed: Array, power: Array) -> NDArray[np.intp]:
    """Indices of the pairs that no other beats (faster and cheaper), by rising speed."""
    order = np.lexsort((power, -speed))  # fastest first; of equals the cheapest
    cheapest = np.minimum.accumulate(np.concatenate([[np.inf], power[order][:-1]]))
    kept = order[power[order] < cheapest]
    return kept[::-1]


def pareto_front(trial: Trial, box: Box, *, evaluations: int, seed: int) -> Front:
    """Search speed / power^x for several x with `evaluations` each; keep what is not dominated of all gaits."""
    units, speeds, powers = [], [], []
    for number, exponent in enumerate(EXPONENTS):
        generations = search(trial, weighted(exponent), box, "cmaes", evaluations=evaluations, seed=seed + number)
        for generation in generations:
            units.append(generation.unit)
            speeds.append(np.where(generation.scores > -1.0, generation.speed, -np.inf))
            powers.append(generation.power)
    unit, speed, power = np.concatenate(units, axis=1), np.concatenate(speeds), np.concatenate(powers)
    kept = not_dominated(speed, power)
    kept = kept[speed[kept] > 0.0]
    return Front(box.alpha(unit[:, kept]), speed[kept], power[kept])
