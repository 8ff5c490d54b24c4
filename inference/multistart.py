"""A fit from several starts: one batch screens them, the best are refined, and the best of these is fitted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from affine_model.curvature import Array
from inference.fit import Fit, fit
from inference.trajectory import Problem


def fit_multistart(problem: Problem, nuisances: tuple[Array, ...], starts: Array, *, keep: int = 2) -> Fit:
    """The best fit from several starts (F, S) of the free parameters.

    One batch screens them. The best `keep` are refined roughly, and the best of these is fitted to the end.
    """
    flat = np.concatenate(nuisances)[:, None]
    unknowns = np.concatenate([starts, np.repeat(flat, starts.shape[1], axis=1)])
    values, _ = problem.residuals(unknowns)
    cost = np.einsum("nb,nb->b", values, values)
    best: Fit | None = None
    for place in np.argsort(cost)[:keep]:
        parameters = problem.parameters.copy()
        parameters[problem.rows()] = starts[:, place]
        candidate = fit(replace(problem, parameters=parameters), nuisances, tolerance=1e-2, most=12)
        if best is None or candidate.misfit < best.misfit:
            best = candidate
    assert best is not None
    return fit(replace(problem, parameters=best.parameters), best.nuisances)
