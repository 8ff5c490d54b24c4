"""Where the fit of a free decay begins: a horizon that grows.

    minimise  |w(unknowns; t < t_release + k periods)|^2 / 2     for k in HORIZONS, each from where the last one ended

A decay's phase runs away with any error of the frequency: over the whole recording the sum of squares has a valley for
every cycle that is gained or lost, and a broad one where the motion is damped to nothing. Over its first period it has
one. w: residuals whitened beside a share DECAY_SHARE of unknown forces (inference.latent_force).

Voss, Timmer and Kurths 2004 describe these valleys and the methods that fit short pieces first; a horizon that grows is
the plainest of them, for a run that begins at a known release.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from affine_model.curvature import Array
from inference.experiment import Experiment
from inference.fit import minimised, split
from inference.latent_force import ELL
from inference.linearise import latent_forces
from inference.motion_time import motion_time
from inference.trajectory import ONE_SIDED, Problem

HORIZONS, STEPS = (1.0, 2.5, 6.0), 3  # periods of the motion that are followed one after the other; steps on each
DECAY_SHARE = 0.05  # of unknown forces, beside which the fits of a decay begin
DAMPED = 1e-2  # of the information's diagonal, to begin with
ROUGH_TOLERANCE, MOST_ROUNDS = 1e-3, 20  # of the fits on the way
FARTHEST = 0.7  # of its own size: how far one step moves an unknown
FEWEST_FRAMES = 6  # that a horizon holds
LEFT = 2  # points that are left in the end
AFTERWARDS = 0.1  # s beyond the last frame that counts
BATCH = 256  # individuals at once: what memory holds for a long recording


def has_decay(problem: Problem) -> bool:
    """Whether a recording among them is a free decay."""
    return any(experiment.release is not None for experiment in problem.experiments)


def fit_from_release(problem: Problem, nuisances: tuple[Array, ...]) -> tuple[Problem, tuple[Array, ...]]:
    """A problem with decays fitted at one horizon after the other, each about the fit before."""
    for periods in HORIZONS:
        early = horizon_of(problem, nuisances, periods)
        unknowns, _ = minimised(early, nuisances, tolerance=ROUGH_TOLERANCE, most=MOST_ROUNDS)
        parameters, nuisances = split(problem, unknowns)
        problem = replace(problem, parameters=parameters)
    return problem, nuisances


@dataclass(frozen=True)
class Points:
    """Points from which a fit may begin: parameter vectors (R, B) and unknowns (P, B), half the sum of squares (B,)."""

    parameters: Array
    unknowns: Array
    cost: Array

    def best(self, count: int) -> Points:
        """The best of them, best first."""
        order = np.argsort(np.where(np.isfinite(self.cost), self.cost, np.inf), kind="stable")[:count]
        return Points(self.parameters[:, order], self.unknowns[:, order], self.cost[order])


def followed_from_release(horizons: tuple[Problem, ...], origin: tuple[Array, ...], plan: Array) -> Points:
    """The LEFT best points out of a grid of parameter vectors (R, B): from each, damped steps in all unknowns at each
    horizon; half of the points fall out after each. origin: the nuisances to begin with.
    """
    same = np.repeat(np.concatenate(origin)[:, None], plan.shape[1], axis=1)
    points = Points(plan, np.concatenate([plan[horizons[0].rows()], same]), np.zeros(plan.shape[1]))
    for early in horizons:
        points = _stepped(early, points)
        points = points.best(max(LEFT, -(-points.cost.size // 2)))
    return points.best(LEFT)


def horizons_of(problem: Problem, nuisances: tuple[Array, ...]) -> tuple[Problem, ...]:
    """The problem at each of HORIZONS, whitened as about the run with these nuisances; none where nothing decays."""
    return tuple(horizon_of(problem, nuisances, periods) for periods in HORIZONS) if has_decay(problem) else ()


def horizon_of(problem: Problem, nuisances: tuple[Array, ...], periods: float) -> Problem:
    """The problem with the first periods of its decays alone, whitened as about the run with these nuisances."""
    experiments = tuple(
        _until(experiment, 2.0 * np.pi * periods * ELL * motion_time(experiment)) for experiment in problem.experiments
    )
    early = replace(problem, experiments=experiments, filters=())
    own = latent_forces(early, early.parameters, nuisances)
    return replace(early, filters=tuple(force.filter(DECAY_SHARE) for force in own))


def _until(experiment: Experiment, after: float) -> Experiment:
    """The experiment with the frames up to that long after its release [s]; one that does not decay is as it was."""
    if experiment.release is None:
        return experiment
    count = max(int(np.searchsorted(experiment.observation.t, experiment.release + after)), FEWEST_FRAMES)
    count = min(count, experiment.used.size)
    return replace(
        experiment,
        observation=experiment.observation.first(count),
        used=experiment.used[:count],
        duration=min(experiment.duration, after + AFTERWARDS),
    )


def _stepped(problem: Problem, points: Points) -> Points:
    """STEPS damped Gauss-Newton steps from each point; one that does not lower the cost is not taken."""
    damping = np.full(points.cost.size, DAMPED)
    residuals = residuals_at(problem, points.parameters, points.unknowns)
    points = replace(points, cost=_half_square(residuals))
    for _ in range(STEPS):
        unknowns = _after_a_step(problem, points, residuals, damping)
        parameters = points.parameters.copy()
        parameters[problem.rows()] = unknowns[: len(problem.free)]
        values = residuals_at(problem, parameters, unknowns)
        cost = _half_square(values)
        better = cost < points.cost
        residuals = np.where(better, values, residuals)
        damping = np.where(better, 0.3 * damping, 10.0 * damping)
        points = Points(
            np.where(better, parameters, points.parameters),
            np.where(better, unknowns, points.unknowns),
            np.where(better, cost, points.cost),
        )
    return points


def _after_a_step(problem: Problem, points: Points, residuals: Array, damping: Array) -> Array:
    """The unknowns (P, B) after a damped Gauss-Newton step of each point's own derivatives."""
    count, lanes = points.unknowns.shape
    scales = np.stack([replace(problem, parameters=column).scales() for column in points.parameters.T], axis=1)
    moved = np.repeat(points.unknowns, count, axis=1) + ONE_SIDED * np.tile(np.eye(count), lanes) * np.repeat(
        scales, count, axis=1
    )
    parameters = np.repeat(points.parameters, count, axis=1)
    parameters[problem.rows()] = moved[: len(problem.free)]
    there = residuals_at(problem, parameters, moved).reshape(-1, lanes, count)
    low, high = problem.bounds()
    ends = np.empty_like(points.unknowns)
    for k in range(lanes):
        slope = (there[:, k] - residuals[:, [k]]) / ONE_SIDED
        information = slope.T @ slope
        scaled = information + damping[k] * np.diag(np.diag(information) + 1e-12)
        step = np.clip(-np.linalg.solve(scaled, slope.T @ residuals[:, k]), -FARTHEST, FARTHEST)
        ends[:, k] = np.clip(points.unknowns[:, k] + step * scales[:, k], low, high)
    return ends


def _half_square(residuals: Array) -> Array:
    return np.asarray(0.5 * np.einsum("nb,nb->b", residuals, residuals))


def residuals_at(problem: Problem, parameters: Array, unknowns: Array) -> Array:
    """Residuals (N, B), in batches that memory holds."""
    parts = range(0, unknowns.shape[1], BATCH)
    return np.concatenate(
        [problem.residuals_of(parameters[:, k : k + BATCH], unknowns[:, k : k + BATCH]) for k in parts], axis=1
    )
