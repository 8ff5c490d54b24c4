"""Successive halving: a grid of points from which a fit may begin, thinned while each point is improved.

    x <- x - (J'J + lambda diag J'J)^-1 J' w(x)        some steps from every point; then the better share goes on

A grid point is not judged where it stands. Beside an effect as large as the arm's own forces the base parameters lie
far from those of any fit without it, so that the cost at the point itself says nothing of the valley that it is in.
Steps as by Marquardt 1963; thinned as by Jamieson and Talwalkar 2016.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from affine_model.curvature import Array
from inference.declared_arm import DECLARED
from inference.trajectory import ONE_SIDED, Problem

DAMPED = 1e-2  # of the information's diagonal, to begin with
FARTHEST = 0.7  # of its own size: how far one step moves an unknown
LEFT = 2  # points that are left in the end
BATCH = 256  # individuals at once: what memory holds for a long recording


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


@dataclass(frozen=True)
class Leg:
    """A part of the way: the problem whose cost is lowered, the steps from each point, and the share of the points that
    goes on. states: whether the initial states move as well, or the free parameters alone. declared: whether the
    uncertain declared numbers do: every value of them asks for a run of its own.
    """

    problem: Problem
    steps: int
    kept: float
    states: bool = True
    declared: bool = True

    @property
    def moving(self) -> NDArray[np.intp]:
        """Places of the unknowns that move."""
        free = [self.declared or effect != DECLARED for effect, _ in self.problem.free]
        return np.flatnonzero([*free, *(self.states for _ in range(sum(self.problem.sizes())))])

    def freed(self, free: tuple[tuple[str, str], ...]) -> Leg:
        """The same leg with these free parameters."""
        return replace(self, problem=replace(self.problem, free=free))


def followed(legs: Sequence[Leg], origin: tuple[Array, ...], plan: Array) -> Points:
    """The LEFT best points out of a grid of parameter vectors (R, B), after all legs. origin: the nuisances to begin
    with.
    """
    same = np.repeat(np.concatenate(origin)[:, None], plan.shape[1], axis=1)
    points = Points(plan, np.concatenate([plan[legs[0].problem.rows()], same]), np.zeros(plan.shape[1]))
    for leg in legs:
        points = _stepped(leg, points)
        points = points.best(max(LEFT, int(np.ceil(leg.kept * points.cost.size))))
    return points.best(LEFT)


def _stepped(leg: Leg, points: Points) -> Points:
    """Damped Gauss-Newton steps from each point; one that does not lower the cost is not taken."""
    problem = leg.problem
    damping = np.full(points.cost.size, DAMPED)
    residuals = residuals_at(problem, points.parameters, points.unknowns)
    points = replace(points, cost=_half_square(residuals))
    for _ in range(leg.steps):
        unknowns = _after_a_step(leg, points, residuals, damping)
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


def _after_a_step(leg: Leg, points: Points, residuals: Array, damping: Array) -> Array:
    """The unknowns (P, B) after a damped Gauss-Newton step of each point's own derivatives."""
    problem, moving, lanes = leg.problem, leg.moving, points.unknowns.shape[1]
    scales = np.stack([replace(problem, parameters=column).scales() for column in points.parameters.T], axis=1)[moving]
    count = len(moving)
    moved = np.repeat(points.unknowns, count, axis=1)
    moved[moving] += ONE_SIDED * np.tile(np.eye(count), lanes) * np.repeat(scales, count, axis=1)
    parameters = np.repeat(points.parameters, count, axis=1)
    parameters[problem.rows()] = moved[: len(problem.free)]
    there = residuals_at(problem, parameters, moved).reshape(-1, lanes, count)
    low, high = (bounds[moving] for bounds in problem.bounds())
    ends = points.unknowns.copy()
    for k in range(lanes):
        slope = (there[:, k] - residuals[:, [k]]) / ONE_SIDED
        information = slope.T @ slope
        scaled = information + damping[k] * np.diag(np.diag(information) + 1e-12)
        step = np.clip(-np.linalg.solve(scaled, slope.T @ residuals[:, k]), -FARTHEST, FARTHEST)
        ends[moving, k] = np.clip(points.unknowns[moving, k] + step * scales[:, k], low, high)
    return ends


def _half_square(residuals: Array) -> Array:
    return np.asarray(0.5 * np.einsum("nb,nb->b", residuals, residuals))


def residuals_at(problem: Problem, parameters: Array, unknowns: Array) -> Array:
    """Residuals (N, B), in batches that memory holds."""
    parts = range(0, unknowns.shape[1], BATCH)
    return np.concatenate(
        [problem.residuals_of(parameters[:, k : k + BATCH], unknowns[:, k : k + BATCH]) for k in parts], axis=1
    )
