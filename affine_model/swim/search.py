"""The loop of a search: ask, try, tell. An interrupted search continues from the scores that it stored."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from affine_model.curvature import Array
from affine_model.swim.limits import Box
from affine_model.swim.methods import METHODS
from affine_model.swim.objectives import Objective, gait_scores
from affine_model.swim.trial import GaitTrial, run
from tentacle.errors import InputError


@dataclass(frozen=True)
class Generation:
    """One batch of a search.

    number counts from 0, evaluations up to and with this batch; unit (9, B) the points, scores (B,) theirs; best_unit
    (9,) and best_score of all so far; speed and power (B,) at the estimates (NaN where replayed).
    """

    number: int
    evaluations: int
    unit: Array
    scores: Array
    best_unit: Array
    best_score: float
    speed: Array
    power: Array


@dataclass(frozen=True)
class SearchPlan:
    """method: a name of METHODS; evaluations: gaits to try; seed; noted: scores of the first generations, from an
    interrupted run of the same search. These gaits are not simulated again, and the search continues exactly as without
    the interruption. polish: climb once more from the best gait, with the exact gradient (needs torch).
    """

    method: str = "cmaes"
    evaluations: int = 5000
    seed: int = 0
    noted: Iterable[Array] = ()
    polish: bool = False


USUAL_SEARCH = SearchPlan()


def search(trial: GaitTrial, objective: Objective, box: Box, plan: SearchPlan) -> Iterator[Generation]:
    """Yield generation after generation until plan.evaluations gaits have been tried.

    Raises InputError where the method is unknown or every gait of a generation diverges.
    """
    if plan.method not in METHODS:
        raise InputError(f"{plan.method!r} is not known", field="method", expected=f"one of {', '.join(METHODS)}")
    searcher, remaining = METHODS[plan.method](plan.seed), iter(plan.noted)
    best_unit, best_score, tried, number = np.full(9, 0.5), -np.inf, 0, 0
    while tried < plan.evaluations:
        unit = searcher.ask()
        values = next(remaining, None)
        speed = power = np.full(unit.shape[1], np.nan)
        if values is None:
            outcome = run(trial, box.alpha(unit))
            if np.all(outcome.diverged):
                raise InputError(
                    "every gait diverges", field="specimen", expected="an arm that the model can integrate"
                )
            values = gait_scores(objective, trial, outcome)
            speed, power = outcome.speed.mean(axis=1), outcome.power.mean(axis=1)
        elif len(values) != unit.shape[1]:
            raise InputError("the noted run was another search", field="resume", expected="the same method and seed")
        searcher.tell(unit, values)
        tried += unit.shape[1]
        leader = int(np.argmax(values))
        if values[leader] > best_score:
            best_unit, best_score = unit[:, leader], float(values[leader])
        yield Generation(number, tried, unit, values, best_unit, best_score, speed, power)
        number += 1
