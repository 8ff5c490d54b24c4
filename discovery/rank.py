"""All sets of up to three absent effects ranked at once, to first order about a fitted model, by linear algebra.

    evidence(T) = max over a of  evidence(a) + gain(T, a)  -  max over a of  evidence(a)
    gain(T, a) = max over p of  (|r|^2 - |r + S_T p|^2) / 2  +  log prior(p)  -  log det(S_T' S_T / 2 pi) / 2

a: share of unknown forces; evidence(a): of the fitted model. r: its whitened residual at a; S: the sensitivities to the
effects' strengths, both freed of what refitting the model's own parameters can absorb. A model that lacks an effect
needs a large share of unknown forces, beside which the effect gains little: beside a small one it gains what it is
worth.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from affine_model.curvature import Array
from inference.posterior import Hypothesis, filters_at
from inference.score import Candidate, responses, score
from inference.whitened_fit import WhitenedFit, whitened_fit


@dataclass(frozen=True)
class RankedSet:
    """A set of candidates, the evidence [nats] that it adds to first order, and the strengths of each effect."""

    candidates: tuple[Candidate, ...]
    evidence: float
    strengths: tuple[Array, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """The effects' names."""
        return tuple(candidate.effect.name for candidate in self.candidates)


def log_cauchy(values: Array, nominal: Array, one_sided: NDArray[np.bool_]) -> float:
    """Log density of strengths under their prior: Cauchy, of the nominal size, one-sided where they have a sign."""
    density = np.where(one_sided, 2.0, 1.0) / (np.pi * nominal * (1.0 + (values / nominal) ** 2))
    return float(np.log(density).sum())


@dataclass(frozen=True)
class Ranking:
    """The candidate effects, best first, and every set of them, best first: about one fitted model."""

    candidates: tuple[Candidate, ...]
    sets: tuple[RankedSet, ...]


def ranking(centre: Hypothesis, most: int, coarsening: float = 1.0) -> Ranking:
    """All sets of up to `most` absent effects beside a model, at its best share of unknown forces and at smaller ones.

    The candidates are those at the best share; the sets have the strengths at the share where each promises most.
    coarsening: T of the decision, with which the set-up's prior is narrowed (inference.pose).
    """
    known = responses(centre.problem, centre.fitted)
    evidence = centre.evidence_at(coarsening)
    best = int(np.argmax(evidence))
    found: dict[tuple[str, ...], RankedSet] = {}
    first: tuple[Candidate, ...] = ()
    for place in range(best, -1, -1):
        filters = filters_at(centre.forces, place, coarsening)
        white = whitened_fit(centre.problem, centre.fitted, filters)
        candidates = score(white, known)
        first = first or tuple(candidates)
        behind = float(evidence[place] - evidence[best])
        for one in ranked_sets(white, candidates, most):
            one = replace(one, evidence=one.evidence + behind)
            name = tuple(sorted(one.names))
            if name not in found or one.evidence > found[name].evidence:
                found[name] = one
    return Ranking(first, tuple(sorted(found.values(), key=lambda one: -one.evidence)))


def ranked_sets(white: WhitenedFit, candidates: Sequence[Candidate], most: int) -> list[RankedSet]:
    """Every set of up to `most` candidates whose estimated strengths lie within their bounds, best first: gain(T)."""
    residual = white.residual
    columns = np.concatenate([c.sensitivity for c in candidates], axis=1) if candidates else np.zeros((0, 0))
    ends = np.cumsum([len(c.effect.strengths) for c in candidates])
    places = [np.arange(end - len(c.effect.strengths), end) for c, end in zip(candidates, ends, strict=True)]
    strengths = [strength for c in candidates for strength in c.effect.strengths]
    nominal = np.array([strength.nominal for strength in strengths])
    low, high = (np.array([strength.bounds[k] for strength in strengths]) for k in (0, 1))
    scaled = columns * nominal
    information, slope = scaled.T @ scaled, -scaled.T @ residual if candidates else np.zeros(0)
    live = np.diag(information) > 1e-6 * residual.size if candidates else np.zeros(0, dtype=bool)
    found = []
    for count in range(1, most + 1):
        for chosen in combinations(range(len(candidates)), count):
            at = np.concatenate([places[k][live[places[k]]] for k in chosen])
            if any(not live[places[k]].any() for k in chosen):
                continue
            matrix = information[np.ix_(at, at)] + 1e-9 * np.diag(np.diag(information)[at])
            scaled_values = np.linalg.solve(matrix, slope[at])
            values = np.asarray(scaled_values * nominal[at], dtype=np.float64)
            if np.any(values < low[at]) or np.any(values > high[at]):
                continue
            gain = 0.5 * float(slope[at] @ scaled_values)
            width = 0.5 * np.linalg.slogdet(matrix / (2.0 * np.pi))[1] - np.log(nominal[at]).sum()
            whole = np.zeros(nominal.size)
            whole[at] = values
            found.append(
                RankedSet(
                    tuple(candidates[k] for k in chosen),
                    gain + log_cauchy(values, nominal[at], low[at] >= 0.0) - float(width),
                    tuple(whole[places[k]] for k in chosen),
                )
            )
    return sorted(found, key=lambda ranked: -ranked.evidence)
