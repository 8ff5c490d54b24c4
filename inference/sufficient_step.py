"""The coarsest step of a fit: its error must be small beside the noise, or beside the unexplained residual."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from affine_model.curvature import Array
from inference.fit import Fit
from inference.trajectory import RAN_AWAY, Problem

CANDIDATE_STEPS = tuple(1.0 / rate for rate in (75, 150, 300, 600, 1200))  # s
OF_NOISE = 0.05  # noise sigmas (rms): one nat in 800 values, nearly the same for all models
OF_REST = 0.02  # of the residual's rms: a finer step would not help a model with such a residual


def sufficient_step(problem: Problem, fitted: Fit, of_noise: float = OF_NOISE) -> float:
    """The coarsest of STEPS [s] at which the fitted motion errs by less than of_noise, or OF_REST of the rest, on the
    fitted frames of every recording and on those kept for judging.

    The error is estimated by halving the step. The midpoint rule is of second order, so the change is three quarters of
    the error. If no step suffices, the finest is returned.
    """
    unknowns = np.concatenate([fitted.values, *fitted.nuisances])[:, None]

    def shown(step: float) -> list[Array]:
        everything = replace(problem, step=step, parameters=fitted.parameters).residuals(unknowns)[1]
        return [
            rows[frames, :, 0]
            for experiment, rows in zip(problem.experiments, everything, strict=True)
            for frames in (experiment.used, ~experiment.used)
            if frames.any()
        ]

    rest = float(np.sqrt(np.mean(fitted.used_residuals**2)))
    allowed = max(of_noise, OF_REST * (rest if rest > 2.0 else 0.0))
    last = shown(CANDIDATE_STEPS[0])
    for coarse, fine in pairwise(CANDIDATE_STEPS):
        finer = shown(fine)
        changes = [np.sqrt(np.mean((a - b) ** 2)) for a, b in zip(finer, last, strict=True)]
        stable = max(float(np.max(np.abs(b))) for b in last) < RAN_AWAY
        if stable and max(changes) < 0.75 * allowed:
            return coarse
        last = finer
    return CANDIDATE_STEPS[-1]
