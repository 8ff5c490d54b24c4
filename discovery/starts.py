"""Where a refit with more effects begins: a grid of shapes and strengths, each judged with the base refitted to it.

A large effect has bent the base parameters to itself, and a law with a shape (a distance, a time, a place) has several
valleys. At each point k of the grid the residual r_k is simulated; what the base and the initial states can absorb of
it, to first order, is taken off: cost_k = |r_k - B B' r_k|^2 / 2, and the base begins at its own best step, -J+ r_k.
Where the first order misleads, some steps of a fit from every point decide (inference.successive_halving).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from affine_model.arm import neutral_parameters, parameter_index, parameter_rows
from affine_model.curvature import Array
from affine_model.declared_laws import SIZES
from affine_model.effect import Effect
from discovery.decide import MOST_DECLARED_FORM
from discovery.rank import RankedSet
from inference.decay import has_decay, horizons_of
from inference.deferred_correction import corrected
from inference.fit import split
from inference.horizon import first_part
from inference.posterior import Hypothesis
from inference.score import Candidate
from inference.successive_halving import LEFT, Leg, Points, followed, residuals_at
from inference.trajectory import Problem
from inference.whitened_fit import LinearRefit

LINEAR_SHARES = (1.0, 0.4)  # of the linear estimate: beyond the linear regime it is too large
SHAPES = 6  # points of the grid of one effect's shapes, at most
# Of successive halving: the share of the motion that is followed, steps from each point, and the share that goes on.
# Chosen, for speed: with all of the motion on each leg 11 recordings had the same answers (docs/loop_trials.md).
FAR_LEGS = ((0.25, 1, 0.25), (0.5, 2, 0.5), (1.0, 3, 0.0))
MOST_BY_THEMSELVES = 2  # strengths of a law, each of which the grid takes by itself
Names = tuple[tuple[str, str], ...]
LARGEST_BASE_MOVE = 0.7  # of its own value: how far a base parameter is moved to begin with


@dataclass(frozen=True)
class RefitStart:
    """Where a refit begins: a parameter vector and each recording's nuisances; half the sum of squares [nats] there."""

    parameters: Array
    nuisances: tuple[Array, ...]
    cost: float


def base_follows(centre: Hypothesis, start: Hypothesis) -> LinearRefit | tuple[Leg, ...]:
    """How the base follows an effect that is added: to first order, or by successive halving. In a decay this goes
    along its horizons; beside a model that is far from the data it goes along FAR_LEGS and moves the free parameters
    alone.
    """
    unmoved = replace(start.problem, parameters=start.fitted.parameters)
    if has_decay(centre.problem):
        return horizons_of(unmoved, start.fitted.nuisances)
    if not is_far(centre):
        return LinearRefit.of(start.problem, start.fitted)
    filters = tuple(force.filter(MOST_DECLARED_FORM) for force in start.forces)
    unknowns = np.concatenate([start.fitted.values, *start.fitted.nuisances])
    whole = replace(unmoved, filters=filters)

    def followed_until(share: float) -> Problem:
        return whole if share == 1.0 else first_part(unmoved, start.fitted.nuisances, share, MOST_DECLARED_FORM)

    return tuple(
        Leg(corrected(followed_until(share), unknowns), steps, kept, states=False) for share, steps, kept in FAR_LEGS
    )


def is_far(centre: Hypothesis) -> bool:
    """Whether a model leaves more of the forces than any declared law may: beside such unknown forces neither the
    first order nor the place where a refit begins says what an effect is worth, so that only its refit does.
    """
    return centre.share > MOST_DECLARED_FORM


def refit_starts(
    centre: Hypothesis, chosen: RankedSet, refit: LinearRefit | tuple[Leg, ...], without: Names = ()
) -> list[RefitStart]:
    """The LEFT best places to begin from, best first. refit: of the base about the centre, or the legs of successive
    halving where the first order misleads: in a decay, and beside a model that is far from the data.

    without: shapes of the effects that keep their neutral values.
    """
    plan = np.stack(_plan(centre, chosen), axis=1)
    left = [parameter_index(*name) for name in without]
    plan[left] = neutral_parameters()[left, None]
    problem = replace(centre.problem, parameters=centre.fitted.parameters)
    if isinstance(refit, LinearRefit):
        points = _absorbed(centre, refit, plan).best(LEFT)
    else:
        plan = _with_nominal_base(centre, plan)
        free = (*problem.free, *(name for one in chosen.candidates for name in one.free if name not in without))
        problem = replace(problem, free=free)
        points = followed([leg.freed(free) for leg in refit], centre.fitted.nuisances, plan)
    found = []
    for parameters, unknowns, cost in zip(points.parameters.T, points.unknowns.T, points.cost, strict=True):
        found.append(RefitStart(*split(replace(problem, parameters=parameters), unknowns), float(cost)))
    return found


def _with_nominal_base(centre: Hypothesis, plan: Array) -> Array:
    """A grid (R, B), and once more with a nominal base where a base parameter stands at its bound. There it does
    not describe the arm, and a fit that begins with a stiffness of zero cannot leave it.
    """
    nominal = {(row.effect, row.parameter.name): row.parameter.nominal for row in parameter_rows()}
    base = [name for name in centre.problem.free if name in nominal and name[0] not in centre.effects]
    if not set(base) & set(centre.fitted.at_bound):
        return plan
    again = plan.copy()
    for name in base:
        again[parameter_index(*name)] = nominal[name]
    return np.concatenate([plan, again], axis=1)


def _absorbed(centre: Hypothesis, refit: LinearRefit, plan: Array) -> Points:
    """A grid of parameter vectors (R, B) after the base's own best step, with the derivatives that it has without
    effects; the initial states stay.
    """
    unknowns = np.concatenate([centre.fitted.values, *centre.fitted.nuisances])
    problem = corrected(replace(centre.problem, parameters=centre.fitted.parameters), unknowns)
    residuals = residuals_at(problem, plan, np.repeat(unknowns[:, None], plan.shape[1], axis=1))
    absorbed = refit.basis.T @ residuals
    cost = np.einsum("nb,nb->b", residuals, residuals) - np.einsum("nb,nb->b", absorbed, absorbed)
    step = refit.steps(residuals)
    step[len(centre.fitted.values) :] = 0.0
    low, high = problem.bounds()
    step = np.clip(step, -LARGEST_BASE_MOVE, LARGEST_BASE_MOVE) * centre.problem.scales()[:, None]
    return Points(plan, np.clip(unknowns[:, None] + step, low[:, None], high[:, None]), 0.5 * cost)


def _plan(centre: Hypothesis, chosen: RankedSet) -> list[Array]:
    """Parameter vectors of the grid: the set's linear estimate and shares of it; of a single effect other shapes that
    the score test likes, and a grid of shapes and sizes too.
    """
    linear = list(zip(chosen.candidates, chosen.strengths, strict=True))
    plan = [with_candidates(centre.fitted.parameters, linear, share) for share in LINEAR_SHARES]
    if len(linear) > 1:
        return plan
    (candidate, estimate), effect = linear[0], linear[0][0].effect
    for strengths, others in candidate.others:
        other = [(replace(candidate, shapes=others), strengths)]
        plan += [with_candidates(centre.fitted.parameters, other, share) for share in LINEAR_SHARES]
    shapes = list(product(*(shape.scan for shape in effect.shapes)))
    if candidate.shapes not in shapes:
        shapes.append(candidate.shapes)
    for values in shapes[:: max(1, -(-len(shapes) // SHAPES))]:
        at = replace(candidate, shapes=values)
        for sized in strength_grid(effect):
            plan.append(with_candidates(centre.fitted.parameters, [(at, sized)], 1.0))
        plan.append(with_candidates(centre.fitted.parameters, [(at, estimate)], 1.0))
    return plan


def strength_grid(effect: Effect, sizes: Sequence[float] = SIZES) -> list[Array]:
    """Strengths of the grid: each by itself in several sizes, times its nominal one. Many are taken together: a step
    finds them all at once, from whatever direction it begins.
    """
    count = len(effect.strengths)
    directions = np.eye(count) if count <= MOST_BY_THEMSELVES else np.ones((1, count))
    found = []
    for direction in directions:
        for size in (*sizes, *(-size for size in sizes)):
            sized = size * direction * np.array([one.nominal for one in effect.strengths])
            if all(one.bounds[0] <= value <= one.bounds[1] for one, value in zip(effect.strengths, sized, strict=True)):
                found.append(sized)
    return found


def with_candidates(parameters: Array, chosen: list[tuple[Candidate, Array]], share: float) -> Array:
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
