"""The evidence of a fit beside a share of unknown forces, by Laplace's method.

    log E = -|w|^2 / 2 - log det(covariance(a)) / 2 + log prior + log det(2 pi N^-1) / 2

w: the residual whitened by the filters (inference.latent_force), priors included; N: information of all unknowns.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from inference.fit import Fit
from inference.latent_force import Filter
from inference.pose import PosteriorPose, posterior_pose
from inference.prior import log_prior, prior_precision
from inference.trajectory import Problem
from inference.whitened_fit import whitened_rows


@dataclass(frozen=True)
class Evidence:
    """log [nats] of the evidence, and the posterior of the errors of the camera's pose."""

    log: float
    pose: PosteriorPose


def evidence_beside(problem: Problem, fitted: Fit, filters: tuple[Filter, ...]) -> Evidence:
    """The evidence beside the share of unknown forces of these filters, after one Gauss-Newton step.

    LinAlgError if it is not finite.
    """
    scale, precision = problem.scales(), prior_precision(problem, fitted)
    constant = 0.5 * len(scale) * np.log(2.0 * np.pi) + log_prior(problem, fitted) + np.log(scale).sum()
    white = whitened_rows(problem, fitted, filters)
    residual, columns = white[:, 0], white[:, 1:] * scale
    information = columns.T @ columns
    slope = columns.T @ residual
    step = np.clip(np.linalg.lstsq(information, -slope, rcond=1e-12)[0], -1.0, 1.0)
    square = float(residual @ residual + 2.0 * slope @ step + step @ information @ step)
    if square > float(residual @ residual):
        step, square = np.zeros(step.size), float(residual @ residual)
    known = information + np.diag(precision * scale**2)
    _, half = np.linalg.slogdet(known)
    seen = sum(one.log_determinant for one in filters)
    found = float(constant - 0.5 * square - 0.5 * half - seen)
    if not np.isfinite(found):
        raise np.linalg.LinAlgError("the evidence is not finite")
    return Evidence(found, posterior_pose(filters, (residual + columns @ step, columns), known))
