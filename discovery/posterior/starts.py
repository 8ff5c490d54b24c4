"""Starts of a refit with more effects: a grid of shapes and strengths, each judged with the base refitted.

    cost_k = |r_k - B B' r_k|^2 / 2,        first step of the base = -J+ r_k

A large missing effect biases the base parameters, and a law with a shape (a distance, a time, a place) has several
minima. r_k is the simulated residual at point k of the grid, J the Jacobian of the base, and B an orthonormal basis of
its columns: the base and the initial states can absorb these to first order.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from affine_model.arm import parameter_index
from affine_model.curvature import Array
from discovery.posterior.rank import RankedSet
from inference.posterior import Hypothesis
from inference.score import Candidate, nuisance_tangent_basis
from inference.trajectory import ONE_SIDED, Problem, split

START_SIZES = (0.5, 2.0, 6.0, 20.0)  # of a strength, in nominal sizes, both signs where bounds allow
SHAPES = 6  # points of the grid of one effect's shapes, at most
KEPT = 2  # starts that are refined
LARGEST_BASE_MOVE = 0.7  # of its own value: the largest first move of a base parameter
STEP_DAMPING = 1e-2  # of the information's diagonal
START_BATCH = 256  # individuals at once: what memory holds for a long recording


@dataclass(frozen=True)
class RefitStart:
    """Start of a refit: a parameter vector, each recording's nuisances; half the sum of squares [nats] there."""

    parameters: Array
    nuisances: tuple[Array, ...]
    cost: float


def refit_starts(centre: Hypothesis, chosen: RankedSet) -> list[RefitStart]:
    """The best KEPT starts, best first."""
    plan = np.stack(_plan(centre, chosen), axis=1)
    problem = replace(centre.problem, parameters=centre.fitted.parameters)
    unknowns = np.concatenate([centre.fitted.values, *centre.fitted.nuisances])
    residuals = _residuals(problem, plan, np.repeat(unknowns[:, None], plan.shape[1], axis=1))
    if any(experiment.release is not None for experiment in problem.experiments):
        cost, moved = _stepped(problem, plan, unknowns, residuals)
    else:
        cost, moved = _absorbed(centre, residuals)
    found = []
    for place in np.argsort(np.where(np.isfinite(cost), cost, np.inf), kind="stable")[:KEPT]:
        parameters, nuisances = split(replace(problem, parameters=plan[:, place]), moved[:, place])
        found.append(RefitStart(parameters, nuisances, float(cost[place])))
    return found


def _residuals(problem: Problem, parameters: Array, unknowns: Array) -> Array:
    """Residuals (N, B), in batches that memory holds."""
    parts = range(0, unknowns.shape[1], START_BATCH)
    return np.concatenate(
        [problem.residuals_of(parameters[:, k : k + START_BATCH], unknowns[:, k : k + START_BATCH]) for k in parts],
        axis=1,
    )


def _absorbed(centre: Hypothesis, residuals: Array) -> tuple[Array, Array]:
    """Cost (B,) and unknowns (P, B) after the base's best step, with its derivatives without effects.

    The initial states stay.
    """
    basis = nuisance_tangent_basis(centre.fitted)
    absorbed = basis.T @ residuals
    cost = np.einsum("nb,nb->b", residuals, residuals) - np.einsum("nb,nb->b", absorbed, absorbed)
    scales, unknowns = centre.problem.scales(), np.concatenate([centre.fitted.values, *centre.fitted.nuisances])
    step = -np.linalg.lstsq(centre.fitted.jacobian * scales, residuals, rcond=1e-8)[0]
    step[len(centre.fitted.values) :] = 0.0
    return 0.5 * cost, _within(
        centre.problem, unknowns[:, None] + np.clip(step, -LARGEST_BASE_MOVE, LARGEST_BASE_MOVE) * scales[:, None]
    )


def _stepped(problem: Problem, plan: Array, unknowns: Array, residuals: Array) -> tuple[Array, Array]:
    """The same for decays: each point of the grid has its own derivatives, and the initial states step too.

    The cost is that at the end of the step. A decay needs this, as a small error of its frequency gives a large error
    of phase.
    """
    scales, count = problem.scales(), unknowns.size
    shift = ONE_SIDED * scales
    shifted = np.concatenate([np.repeat(plan[:, [k]], count, axis=1) for k in range(plan.shape[1])], axis=1)
    moved = np.tile(unknowns[:, None] + np.diag(shift), plan.shape[1])
    shifted[problem.rows()] = moved[: len(problem.free)]
    there = _residuals(problem, shifted, moved)
    ends = []
    for k in range(plan.shape[1]):
        slope = (there[:, k * count : (k + 1) * count] - residuals[:, [k]]) / ONE_SIDED
        information = slope.T @ slope
        step = -np.linalg.solve(
            information + STEP_DAMPING * np.diag(np.diag(information) + 1e-12), slope.T @ residuals[:, k]
        )
        ends.append(unknowns + np.clip(step, -LARGEST_BASE_MOVE, LARGEST_BASE_MOVE) * scales)
    moved = _within(problem, np.stack(ends, axis=1))
    stepped = plan.copy()
    stepped[problem.rows()] = moved[: len(problem.free)]
    values = _residuals(problem, stepped, moved)
    return 0.5 * np.einsum("nb,nb->b", values, values), moved


def _within(problem: Problem, unknowns: Array) -> Array:
    low, high = problem.bounds()
    return np.clip(unknowns, low[:, None], high[:, None])


def _plan(centre: Hypothesis, chosen: RankedSet) -> list[Array]:
    """Parameter vectors of the grid: the set's linear estimate and a share of it; for a single effect also shapes,
    sizes.
    """
    linear = list(zip(chosen.candidates, chosen.strengths, strict=True))
    plan = [_with(centre.fitted.parameters, linear, share) for share in (1.0, 0.4)]
    if len(linear) > 1:
        return plan
    (candidate, estimate), effect = linear[0], linear[0][0].effect
    shapes = list(product(*(shape.scan for shape in effect.shapes)))
    if candidate.shapes not in shapes:
        shapes.append(candidate.shapes)
    for values in shapes[:: max(1, -(-len(shapes) // SHAPES))]:
        at = replace(candidate, shapes=values)
        for place, strength in enumerate(effect.strengths):
            for size in (*START_SIZES, *(-size for size in START_SIZES)):
                if strength.bounds[0] <= size * strength.nominal <= strength.bounds[1]:
                    sized = np.zeros(len(effect.strengths))
                    sized[place] = size * strength.nominal
                    plan.append(_with(centre.fitted.parameters, [(at, sized)], 1.0))
        plan.append(_with(centre.fitted.parameters, [(at, estimate)], 1.0))
    return plan


def _with(parameters: Array, chosen: list[tuple[Candidate, Array]], share: float) -> Array:
    """The parameter vector with the candidates at that share of their strengths, strictly within their bounds.

    At a bound the difference quotients are one-sided, and a fit may not leave it.
    """
    parameters = parameters.copy()
    for candidate, values in chosen:
        effect = candidate.effect
        for shape, value in zip(effect.shapes, candidate.shapes, strict=True):
            low, high = shape.bounds
            inside = 0.02 * (high - low)
            parameters[parameter_index(effect.name, shape.name)] = np.clip(value, low + inside, high - inside)
        for strength, value in zip(effect.strengths, share * values, strict=True):
            low, high = strength.bounds
            reach = 20.0 * strength.nominal
            kept = np.clip(value, low + 1e-2 * strength.nominal, high - 1e-2 * strength.nominal)
            parameters[parameter_index(effect.name, strength.name)] = np.clip(kept, -reach, reach)
    return parameters
