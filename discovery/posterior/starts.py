"""Where a refit with more effects begins: a grid of shapes and strengths, each judged with the base refitted to it.

A large effect has bent the base parameters to itself, and a law with a shape (a distance, a time, a place) has several
valleys. At each point k of the grid the residual r_k is simulated; what the base and the initial states can absorb of
it, to first order, is taken off: cost_k = |r_k - B B' r_k|^2, and the base begins at its own best step, -J+ r_k.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np

from affine_model.arm import parameter_index
from affine_model.curvature import Array
from discovery.posterior.rank import RankedSet
from inference.posterior import Hypothesis
from inference.score import Candidate, absorbed_basis

SIZES = (0.5, 2.0, 6.0, 20.0)  # of a strength, in nominal sizes, both signs where bounds allow
SHAPES = 6  # points of the grid of one effect's shapes, at most
KEPT = 2  # starts that are refined
BENT = 0.7  # of its own value: how far a base parameter is moved to begin with


def starts(centre: Hypothesis, chosen: RankedSet) -> list[Array]:
    """The best KEPT parameter vectors to begin from, best first."""
    plan = _plan(centre, chosen)
    problem = replace(centre.problem, parameters=centre.fitted.parameters)
    unknowns = np.concatenate([centre.fitted.values, *centre.fitted.nuisances])
    columns = np.stack(plan, axis=1)
    residuals = problem.residuals_of(columns, np.repeat(unknowns[:, None], len(plan), axis=1))
    basis = absorbed_basis(centre.fitted)
    cost = np.einsum("nb,nb->b", residuals, residuals) - np.einsum("nb,nb->b", *(2 * (basis.T @ residuals,)))
    scales = problem.scales()
    count = len(centre.fitted.values)
    found = []
    for place in np.argsort(np.where(np.isfinite(cost), cost, np.inf), kind="stable")[:KEPT]:
        step = -np.linalg.lstsq(centre.fitted.jacobian * scales, residuals[:, place], rcond=1e-8)[0][:count]
        low, high = (limit[:count] for limit in problem.bounds())
        base = centre.fitted.values + np.clip(step, -BENT, BENT) * scales[:count]
        parameters = plan[place].copy()
        parameters[problem.rows()] = np.clip(base, low, high)
        found.append(parameters)
    return found


def _plan(centre: Hypothesis, chosen: RankedSet) -> list[Array]:
    """Parameter vectors of the grid: the set's linear estimate and shares of it; of a single effect all shapes and sizes
    too.
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
            for size in (*SIZES, *(-size for size in SIZES)):
                if strength.bounds[0] <= size * strength.nominal <= strength.bounds[1]:
                    sized = np.zeros(len(effect.strengths))
                    sized[place] = size * strength.nominal
                    plan.append(_with(centre.fitted.parameters, [(at, sized)], 1.0))
        plan.append(_with(centre.fitted.parameters, [(at, estimate)], 1.0))
    return plan


def _with(parameters: Array, chosen: list[tuple[Candidate, Array]], share: float) -> Array:
    """The parameter vector with the candidates in it at that share of their strengths, within bounds and on none: there
    the difference quotients are one-sided and a fit may stick.
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
