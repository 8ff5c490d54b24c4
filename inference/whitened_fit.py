"""A fit about its minimum, whitened beside any share of unknown forces: what a refit can absorb, and what it cannot.

    r(p, s) = r + J p + S s,        B = orthonormal basis of J's columns,        freed(X) = X - B (B' X)

r: whitened residuals with the priors' rows; p: changes of the model's own unknowns; s: strengths of absent effects.
Residuals and derivatives are simulated once; the Kalman filter of each share (inference.latent_force) whitens them
anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from affine_model.curvature import Array
from inference.fit import Fit
from inference.latent_force import Filter
from inference.trajectory import Problem


@dataclass(frozen=True)
class WhitenedFit:
    """residual (N,), freed of what a refit absorbs; basis (N, P) of that; filters: of each recording (none: white
    noise alone).
    """

    residual: Array
    basis: Array
    problem: Problem
    filters: tuple[Filter, ...]

    def freed(self, columns: Array) -> Array:
        """Columns (N, B) without what a refit of the model's own unknowns absorbs."""
        return columns - self.basis @ (self.basis.T @ columns)

    def columns(self, slopes: Sequence[Array]) -> Array:
        """Derivatives (T, K, B) of each recording's residuals as freed columns (N, B); no prior knows of them."""
        white = whitened(self.problem, slopes, self.filters)
        priors = np.zeros((self.residual.size - white.shape[0], white.shape[1]))
        return self.freed(np.concatenate([white, priors]))


def whitened_fit(problem: Problem, fitted: Fit, filters: tuple[Filter, ...] | None = None) -> WhitenedFit:
    """The fit, whitened by these filters (None: as it was fitted)."""
    filters = problem.filters if filters is None else filters
    rows = whitened_rows(problem, fitted, filters)
    basis = tangent_basis(rows[:, 1:])
    return WhitenedFit(rows[:, 0] - basis @ (basis.T @ rows[:, 0]), basis, problem, filters)


@dataclass(frozen=True)
class LinearRefit:
    """A refit to first order, of any number of residuals r (N, B): what it absorbs, B B' r, and its steps, -J+ r.

    basis (N, P): orthonormal, of J's columns; inverse (P, N): J+, with J in the unknowns' scales.
    """

    basis: Array
    inverse: Array

    @staticmethod
    def of(problem: Problem, fitted: Fit) -> LinearRefit:
        """The refit about a fitted model."""
        inverse = np.linalg.pinv(fitted.jacobian * problem.scales(), 1e-8)
        return LinearRefit(tangent_basis(fitted.jacobian), np.asarray(inverse, dtype=np.float64))

    def steps(self, residuals: Array) -> Array:
        """The steps (P, B) in the unknowns' scales that lower these residuals (N, B) most."""
        return -self.inverse @ residuals


def tangent_basis(jacobian: Array) -> Array:
    """Orthonormal basis (N, P) of what a refit of the model's own parameters and initial states can absorb."""
    scaled = jacobian / np.maximum(np.linalg.norm(jacobian, axis=0), 1e-300)
    left, singular, _ = np.linalg.svd(scaled, full_matrices=False)
    return left[:, singular > 1e-9 * singular[0]]


def whitened_rows(problem: Problem, fitted: Fit, filters: tuple[Filter, ...]) -> Array:
    """Residual and Jacobian (N, 1 + P): the whitened rows of all recordings, then those of the priors."""
    both = [
        np.concatenate([rows[:, :, None], slopes], axis=2)
        for rows, slopes in zip(fitted.residuals, fitted.slopes, strict=True)
    ]
    return np.concatenate([whitened(problem, both, filters), _prior_rows(problem, fitted)])


def whitened(problem: Problem, rows: Sequence[Array], filters: tuple[Filter, ...]) -> Array:
    """Rows (T, K, B) of each recording, whitened: (N, B), on the used frames."""
    if filters:
        return np.concatenate([one.whiten(own) for one, own in zip(filters, rows, strict=True)])
    both = zip(problem.experiments, rows, strict=True)
    return np.concatenate([own[experiment.used].reshape(-1, own.shape[2]) for experiment, own in both])


def _prior_rows(problem: Problem, fitted: Fit) -> Array:
    """Rows [residual, Jacobian] of the priors alone."""
    rows = [int(e.used.sum()) * e.noise_gain.size for e in problem.experiments]
    if problem.filters:
        rows = [one.rows for one in problem.filters]
    place, kept = 0, list[int]()
    for experiment, nuisances, size in zip(problem.experiments, fitted.nuisances, rows, strict=True):
        place += size
        count = experiment.prior_residuals(problem.arm.order, problem.arm.specimen.length, nuisances[:, None]).shape[0]
        kept += list(range(place, place + count))
        place += count
    kept += list(range(place, fitted.used_residuals.size))
    return np.concatenate([fitted.used_residuals[kept, None], fitted.jacobian[kept]], axis=1)
