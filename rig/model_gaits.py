"""The best gaits of a model, which the rig tries first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from affine_model.arm import arm_of, parameter_vector
from affine_model.simulate import Timing, simulate
from rig.gait_space import GaitSpace, TrialPlan
from tentacle.model import Model
from tentacle.signals import Array

GAIT_STEP = 1.0 / 250.0  # s
GAITS_AT_ONCE = 128
APART = 0.25  # of the space's width: closer points are the same proposal


def predicted_propulsion(
    model: Model, space: GaitSpace, points: Sequence[Mapping[str, float]], plan: TrialPlan
) -> Array:
    """Mean propulsion (B,) [N] of each point: minus the mean of eq. 17 along +y over the counted periods; NaN if
    unstable.
    """
    arm, row = arm_of(model), parameter_vector(model)
    result = np.full(len(points), np.nan)
    by_length = sorted(range(len(points)), key=lambda k: points[k]["frequency_hz"])  # a batch is as long as its longest
    for low in range(0, len(points), GAITS_AT_ONCE):
        part = by_length[low : low + GAITS_AT_ONCE]
        steps = int(np.ceil(plan.duration(points[part[0]]["frequency_hz"]) / GAIT_STEP))
        t = GAIT_STEP * (np.arange(steps) + 0.5)
        base = np.stack([space.gait(points[k])(t) for k in part], axis=-1)
        parameters = np.repeat(row[:, None], len(part), axis=1)
        batch = simulate(arm, parameters, base, Timing(GAIT_STEP))
        for place, k in enumerate(part):
            begin, end = (round(x / GAIT_STEP) for x in plan.window(points[k]["frequency_hz"]))
            if np.isnan(batch.diverged[place]):
                result[k] = -float(batch.fluid_force[begin:end, 1, place].mean())
    return result


def best_gaits(model: Model, space: GaitSpace, plan: TrialPlan, count: int, seed: int) -> list[dict[str, float]]:
    """The model's best points, best first, no two close together: a spread of samples, then a local search from the
    best.
    """
    points = space.sample(512, seed)
    scores = predicted_propulsion(model, space, points, plan)
    points, scores = _refined(model, space, plan, points, scores, seed)
    bounds = np.array(list(space.bounds.values()))
    chosen: list[dict[str, float]] = []
    for k in np.argsort(-np.nan_to_num(scores, nan=-np.inf)):
        if np.isnan(scores[k]) or len(chosen) == count:
            break
        here = _unit(points[k], bounds)
        if all(np.abs(here - _unit(other, bounds)).max() > APART for other in chosen):
            chosen.append(points[k])
    return chosen


def _refined(
    model: Model, space: GaitSpace, plan: TrialPlan, points: list[dict[str, float]], scores: Array, seed: int
) -> tuple[list[dict[str, float]], Array]:
    """Adds ever narrower clouds around the ten best."""
    random = np.random.default_rng(seed)
    names, bounds = list(space.bounds), np.array(list(space.bounds.values()))
    for width in (0.1, 0.03, 0.01):
        best = np.argsort(-np.nan_to_num(scores, nan=-np.inf))[:10]
        fresh = []
        for k in best:
            near = np.array(list(points[k].values())) + width * np.ptp(bounds, axis=1) * random.normal(
                size=(24, len(names))
            )
            fresh += [dict(zip(names, row, strict=True)) for row in np.clip(near, bounds[:, 0], bounds[:, 1]).tolist()]
        points = points + fresh
        scores = np.concatenate([scores, predicted_propulsion(model, space, fresh, plan)])
    return points, scores


def _unit(point: Mapping[str, float], bounds: Array) -> Array:
    return (np.array(list(point.values())) - bounds[:, 0]) / np.ptp(bounds, axis=1)
