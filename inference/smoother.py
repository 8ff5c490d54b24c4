"""The smoothed state of an arm that a latent force drives: what all cells of a recording say of each of them.

    m_k|all = m_k + G_k (m_k+1|all - F m_k),    G_k = P_k F' (F P_k F' + Q)^-1    (Rauch, Tung and Striebel 1965)

m_k, P_k: the Kalman filter's mean and covariance in cell k; F, Q: transition and added covariance to the next cell.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from affine_model.curvature import Array
from inference.kalman import filtered_along, smoothed_along
from inference.latent_force import LatentForce, discretised

TIME_SCALE = 0.08  # s, of the latent force: short enough for a stop or a jet
SMOOTHER_SHARES = (0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0)  # of the acting forces
START_SHAPE, START_RATE = 0.3, 5.0  # rad, rad/s of the state before the first frame


@dataclass(frozen=True)
class Smoothed:
    """The state [d, d', f, f', offsets] in every cell given all of them: mean and standard deviation (C, 4 n + O); f in
    units of share times the acting forces; log_likelihood [nats].
    """

    mean: Array
    deviation: Array
    share: float
    log_likelihood: float


@dataclass(frozen=True)
class Filtered:
    """The filter's mean (C, N) and covariance (C, N, N) in every cell, the transition and the covariance that is added
    between cells (N, N), at a share of unknown forces; log_likelihood [nats].
    """

    mean: Array
    covariance: Array
    transition: Array
    added: Array
    share: float
    log_likelihood: float

    def smoothed(self) -> Smoothed:
        """What all cells say of each. Source: Rauch, Tung and Striebel 1965."""
        mean, deviation = smoothed_along(self.mean, self.covariance, self.transition, self.added)
        return Smoothed(mean, deviation, self.share, self.log_likelihood)


def likeliest(force: LatentForce, given: tuple[Array, Array]) -> Smoothed:
    """The smoothed state at the share of unknown forces that makes the given cells the likeliest."""
    each = (filtered(force, given, float(share)) for share in SMOOTHER_SHARES)
    return max(each, key=lambda one: one.log_likelihood).smoothed()


def filtered(force: LatentForce, given: tuple[Array, Array], share: float) -> Filtered:
    """The filtered state, driven by a latent force alone; servo and camera are assumed to be right.

    given: the model's whitened residuals (C, K) in the cells, and how they see d and O constant offsets (C, K, n + O).
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
    transition, added, _ = discretised(drift, diffusion, force.cells.interval)
    start = np.diag(np.append(np.repeat(np.square([START_SHAPE, START_RATE, 1.0, rate]), n), np.ones(offsets)))
    seen = np.zeros((*rows.shape, size))
    seen[:, :, :n], seen[:, :, 4 * n :] = columns[:, :, :n], columns[:, :, n:]
    mean, covariance, likelihood = filtered_along(np.ascontiguousarray(rows), seen, transition, added, start)
    return Filtered(mean, covariance, transition, added, share, likelihood)
