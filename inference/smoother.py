"""The smoothed state of an arm that a latent force drives: what all cells of a recording say of each of them.

    m_k|all = m_k + G_k (m_k+1|all - F m_k),    G_k = P_k F' (F P_k F' + Q)^-1    (Rauch, Tung and Striebel 1965)

m_k, P_k: the Kalman filter's mean and covariance in cell k; F, Q: transition and added covariance to the next cell.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from affine_model.curvature import Array
from inference.latent_force import LatentForce, discretised

TIME_SCALE = 0.08  # s, of the latent force: short enough for a stop or a jet
SMOOTHER_SHARES = (0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0)  # of the acting forces
START_SHAPE, START_RATE, TINY = 0.3, 5.0, 1e-10  # rad, rad/s of the state before the first frame; against rounding


@dataclass(frozen=True)
class Smoothed:
    """The state [d, d', f, f', offsets] in every cell given all of them: mean and standard deviation (C, 4 n + O); f in
    units of share times the acting forces; log_likelihood [nats].
    """

    mean: Array
    deviation: Array
    share: float
    log_likelihood: float


def likeliest(force: LatentForce, given: tuple[Array, Array]) -> Smoothed:
    """The smoothed state at the share of unknown forces that makes the given cells the likeliest."""
    return max((smoothed(force, given, float(share)) for share in SMOOTHER_SHARES), key=lambda one: one.log_likelihood)


def smoothed(force: LatentForce, given: tuple[Array, Array], share: float) -> Smoothed:
    """The smoothed state, driven by a latent force alone; servo and camera are assumed to be right.

    given: the model's whitened residuals (C, K) in the cells, and how they see d and O constant offsets (C, K, n + O).
    Source: Rauch, Tung and Striebel 1965.
    """
    rows, columns = given
    lin, n = force.linearised, force.linearised.mass.shape[0]
    rate, inverse, one = np.sqrt(3.0) / TIME_SCALE, np.linalg.inv(lin.mass[:, :n]), np.eye(n)
    offsets = columns.shape[2] - n
    size = 4 * n + offsets
    drift, diffusion, none = np.zeros((size, size)), np.zeros((size, size)), np.zeros((n, n))
    drift[:n, : 4 * n] = np.hstack([none, one, none, none])
    by_force = share * inverse @ lin.force_root
    drift[n : 2 * n, : 4 * n] = np.hstack(
        [-inverse @ lin.stiffness[:, :n], -inverse @ lin.damping[:, :n], by_force, none]
    )
    drift[2 * n : 3 * n, : 4 * n] = np.hstack([none, none, none, one])
    drift[3 * n : 4 * n, : 4 * n] = np.hstack([none, none, -(rate**2) * one, -2.0 * rate * one])
    diffusion[3 * n : 4 * n, 3 * n : 4 * n] = 4.0 * rate**3 * one
    forward, added, _ = discretised(drift, diffusion, force.cells.interval)
    mean = np.zeros(size)
    covariance = np.diag(np.append(np.repeat(np.square([START_SHAPE, START_RATE, 1.0, rate]), n), np.ones(offsets)))
    ahead, filtered, likelihood = [], [], 0.0
    for k in range(rows.shape[0]):
        if k > 0:
            mean, covariance = forward @ mean, forward @ covariance @ forward.T + added
        ahead.append((mean, covariance))
        seen = np.hstack([columns[k, :, :n], np.zeros((rows.shape[1], 3 * n)), columns[k, :, n:]])
        error, cross = rows[k] - seen @ mean, covariance @ seen.T
        factor = cho_factor(seen @ cross + np.eye(seen.shape[0]), lower=True)
        likelihood -= 0.5 * float(error @ cho_solve(factor, error)) + float(np.log(np.diag(factor[0])).sum())
        mean = mean + cross @ cho_solve(factor, error)
        covariance = covariance - cross @ cho_solve(factor, cross.T)
        covariance = 0.5 * (covariance + covariance.T)
        filtered.append((mean, covariance))
    means, deviations = np.zeros((2, len(filtered), size))
    for k in range(len(filtered) - 1, -1, -1):
        if k < len(filtered) - 1:
            (own, spread), (predicted, uncertain) = filtered[k], ahead[k + 1]
            back = np.linalg.solve(uncertain + TINY * np.diag(np.diag(uncertain)), forward @ spread).T
            mean = own + back @ (mean - predicted)
            covariance = spread + back @ (covariance - uncertain) @ back.T
        means[k], deviations[k] = mean, np.sqrt(np.maximum(np.diag(covariance), 0.0))
    return Smoothed(means, deviations, share, likelihood)
