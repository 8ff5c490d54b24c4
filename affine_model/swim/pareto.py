"""The Pareto front of speed against power: gaits for which no other gait is both faster and cheaper."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from affine_model.curvature import Array
from affine_model.swim.limits import Box, search_box
from affine_model.swim.objectives import gait_scores, weighted
from affine_model.swim.polish import polish
from affine_model.swim.search import SearchPlan, search
from affine_model.swim.trial import PAPER_RAIL, GaitTrial, run
from tentacle.gait import Gait

EXPONENTS = (
    0.0,
    0.2,
    0.35,
    0.5,
    0.65,
    0.8,
    0.9,
    1.0,
)  # of the power in speed / power^x: from the fastest to the cheapest


@dataclass(frozen=True)
class Front:
    """alpha (9, P), speed (P,) [m/s] and power (P,) [W], by rising speed; amplitudes within the servo's limits."""

    alpha: Array
    speed: Array
    power: Array


def not_dominated(speed: Array, power: Array) -> NDArray[np.intp]:
    """Indices of the pairs that no other beats (faster and cheaper), by rising speed."""
    order = np.lexsort((power, -speed))  # fastest first; of equals the cheapest
    cheapest = np.minimum.accumulate(np.concatenate([[np.inf], power[order][:-1]]))
    kept = order[power[order] < cheapest]
    return kept[::-1]


def pareto_front(trial: GaitTrial, box: Box, *, known: Array, evaluations: int, seed: int) -> Front:
    """Search speed / power^x for every x of EXPONENTS, with `evaluations` gaits in all, and keep the gaits that are not
    dominated.

    trial on the rail, one parameter sample. known (9, M): gaits that are tried too (the best, the best sine).
    """
    tried = [known]
    for number, exponent in enumerate(EXPONENTS):
        objective, share = weighted(exponent), evaluations // len(EXPONENTS)
        best_unit = np.full(9, 0.5)
        for generation in search(trial, objective, box, SearchPlan("cmaes", evaluations=share, seed=seed + number)):
            best_unit = generation.best_unit
            tried.append(box.alpha(generation.unit))
        polished = polish(trial, objective, box, best_unit).point  # a start of the front, at its top or below
        # Between two exponents the front is filled by the same gait, weaker and weaker.
        shares = np.linspace(1.0, 0.6, 9)
        weaker = np.repeat(run(trial, box.alpha(polished[:, None])).alpha, len(shares), axis=1)
        weaker[:3] *= shares
        tried.append(weaker)
    outcome = run(trial, np.concatenate(tried, axis=1))
    usable = gait_scores(weighted(0.0), trial, outcome) > 0.0
    speed, power = outcome.speed[usable, 0], outcome.power[usable, 0]
    kept = not_dominated(speed, power)
    return Front(outcome.alpha[:, usable][:, kept], speed[kept], power[kept])


def front_around(trial: GaitTrial, gait: Gait, sine: Gait, seed: int) -> Front:
    """The front of speed against power of the clamped trial's arm on the rail; gait and sine are tried too."""
    known = np.array([gait.alpha, sine.alpha]).T
    level = trial.on_rail(PAPER_RAIL)
    return pareto_front(level, search_box(trial.limits), known=known, evaluations=8000, seed=seed)
