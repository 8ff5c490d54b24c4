"""Sets that a larger fitted set contains, fitted again from where the larger one stands.

    E(S) < E(U) - FAR,  S a subset of U:  S begins at U's parameters, with the other effects absent

Either an effect of U that S lacks acts, or the fit of S ended in another valley. The evidence alone cannot tell which.
A rough fit that begins in U's valley can: if it leaves less than the known fit of S beside the same unknown forces, S
is fitted closely from there. E: log evidence. The converse, a larger set that explains less than a smaller one, is in
discovery.search.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from discovery.refits import removed
from inference.posterior import Hypothesis, RoughFit, with_derivatives

Pair = tuple[frozenset[str], frozenset[str]]  # a set, and the larger one where it begins


def nested_pairs(tried: dict[frozenset[str], Hypothesis], far: float) -> list[Pair]:
    """Each set that lies far behind a larger one, with the best of those."""
    evidence = {effects: h.highest() for effects, h in tried.items()}
    found = []
    for effects in filter(None, tried):
        larger = [other for other in tried if effects < other]
        best = max(larger, key=lambda other: evidence[other], default=None)
        if best is not None and evidence[effects] < evidence[best] - far:
            found.append((effects, best))
    return found


def nested_refit(tried: dict[frozenset[str], Hypothesis], pair: Pair) -> Callable[[], RoughFit]:
    """The rough fit of a pair's smaller set, to be called."""
    effects, larger = pair
    return partial(removed, with_derivatives(tried[larger]), *sorted(larger - effects))


def stands_in_another_valley(known: Hypothesis, rough: RoughFit, far: float) -> bool:
    """Whether a rough fit of a set leaves less by `far` nats than the known fit does beside the same forces."""
    problem = replace(known.problem, filters=rough.problem.filters)
    unknowns = np.concatenate([known.fitted.parameters[problem.rows()], *known.fitted.nuisances])
    left = 0.5 * float(np.sum(problem.residuals(unknowns[:, None])[0] ** 2))
    return rough.cost < left - far
