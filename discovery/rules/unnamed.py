"""The unnamed rest: after the catalogue a few smooth terms of `unnamed`, if they help on held-out frames."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from affine_model.arm import parameter_index
from affine_model.curvature import Array
from affine_model.effects import catalogue
from inference.hypothesis import GatedHypothesis, gated_hypothesis, held_out_misfit, nats_per_parameter
from inference.score import nuisance_tangent_basis, sensitivities
from inference.trajectory import fit

UNNAMED_EFFECT = "unnamed"
MOST_TERMS = 3
LARGEST_SHARE = 0.9  # of the held-out misfit beyond the noise: terms that leave more are not used


@dataclass(frozen=True)
class UnnamedRest:
    """The chosen model refitted with the terms; their names; the share of the held-out misfit beyond the noise that
    they leave.
    """

    refitted: GatedHypothesis
    terms: tuple[str, ...]
    share: float


def unnamed_rest(chosen: GatedHypothesis) -> UnnamedRest | None:
    """The terms of the rest that are worth their penalty, chosen one by one, then refitted with the whole model.

    None if no term is worth it, if nothing was held out, or if the held-out frames are not predicted better.
    """
    count = _held_out_values(chosen)
    terms, strengths = _chosen_terms(chosen)
    if not count or not terms:
        return None
    parameters = chosen.fitted.parameters.copy()
    limits = {parameter.name: parameter.bounds for parameter in catalogue()[UNNAMED_EFFECT].parameters}
    for term, strength in zip(terms, strengths, strict=True):
        parameters[parameter_index(UNNAMED_EFFECT, term)] = np.clip(strength, *limits[term])
    free = (*chosen.problem.free, *((UNNAMED_EFFECT, term) for term in terms))
    problem = replace(chosen.problem, free=free, parameters=parameters)
    fitted = fit(problem, chosen.fitted.nuisances, tolerance=1e-5, most=20)
    before, after = (
        held_out_misfit(problem, one) - 0.5 * count for one in (chosen.fitted, fitted)
    )  # beyond the noise [nats]
    price = nats_per_parameter(problem) * len(terms)
    if before < price or after > LARGEST_SHARE * before or before - after < price:
        return None
    refitted = gated_hypothesis(
        chosen.effects, replace(problem, parameters=fitted.parameters), fitted, chosen.reduction
    )
    return UnnamedRest(refitted, terms, max(after, 0.0) / before)


def _held_out_values(chosen: GatedHypothesis) -> int:
    """How many residuals the held-out frames have."""
    return sum(
        int(np.count_nonzero(residuals[~experiment.used]))
        for experiment, residuals in zip(chosen.problem.experiments, chosen.fitted.residuals, strict=True)
    )


def _chosen_terms(chosen: GatedHypothesis) -> tuple[tuple[str, ...], Array]:
    """Names and first-order strengths of the terms, each worth its penalty beside those before it."""
    effect = catalogue()[UNNAMED_EFFECT]
    ((_, raw),) = sensitivities(chosen.problem, chosen.fitted, (effect,))[UNNAMED_EFFECT]
    basis = nuisance_tangent_basis(chosen.fitted)
    columns = raw - basis @ (basis.T @ raw)
    residual = chosen.fitted.used_residuals - basis @ (basis.T @ chosen.fitted.used_residuals)
    terms: list[int] = []
    strengths, gained = np.zeros(0), 0.0
    while len(terms) < MOST_TERMS:
        trials = [_explained(columns[:, [*terms, k]], residual) for k in range(columns.shape[1])]
        best = int(np.argmax([gain for _, gain in trials]))
        if best in terms or trials[best][1] - gained < nats_per_parameter(chosen.problem):
            break
        terms.append(best)
        strengths, gained = trials[best]
    return tuple(effect.parameters[k].name for k in terms), strengths


def _explained(columns: Array, residual: Array) -> tuple[Array, float]:
    """Strengths of columns together and their gain [nats], to first order."""
    strengths: Array = np.linalg.lstsq(columns, -residual, rcond=1e-8)[0].astype(np.float64)
    explained = columns @ strengths
    return strengths, float(-residual @ explained - 0.5 * explained @ explained)
