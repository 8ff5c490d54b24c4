"""Rows of a recording whitened for the state that changes in time: the innovations of a Kalman filter.

    y_k = [S_k, S'_k] (H_k x_k, 0)' + noise,      white_k = [R_k (S_k' y_k - H_k x_k|k-1), S'_k' y_k]

[S, S']: an orthonormal rotation of each cell's rows. Only the first E of the turned rows see the state; the others are
white noise as they are. R: inverse Cholesky factor of the innovation's covariance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from affine_model.curvature import Array
from inference.kalman import gains_along, whitened_along

StateMotion = tuple[Array, Array, Array, int]  # transition, forced, envelope and first: see inference.kalman


@dataclass(frozen=True)
class Innovations:
    """The filter: motion; observation (C, E, N); gain (C, N, E); root (C, E, E); log_determinant: half that of the
    covariance [nats]; seeing: [S, S'] (C, K, K), None if all rows see the state.
    """

    motion: StateMotion
    observation: Array
    gain: Array
    root: Array
    log_determinant: float
    seeing: Array | None

    @staticmethod
    def along(motion: StateMotion, noise: tuple[Array, Array], observation: Array, seeing: Array | None) -> Innovations:
        """The filter with that added covariance and that at the start (N, N); observation (C, K, N) of all rows."""
        if seeing is not None:
            alone = observation.shape[2] - (motion[3] + motion[1].shape[1])  # the errors, after the latent forces
            observation = np.matmul(seeing[:, :, :alone].transpose(0, 2, 1), observation)
        gain, root, half = gains_along(motion, *noise, observation)
        return Innovations(motion, observation, gain, root, float(half), seeing)

    def of(self, rows: Array, push: Array | None = None) -> Array:
        """Rows of cells (C, K, B) as independent ones of unit variance (C K, B).

        push (C, M, B): what moves the arm in each column and the filter does not know.
        """
        push = np.zeros((0, 0, rows.shape[2])) if push is None else push
        count = self.observation.shape[1]
        turned = rows if self.seeing is None else np.matmul(self.seeing.transpose(0, 2, 1), rows)
        seen = np.ascontiguousarray(turned[:, :count])
        white = whitened_along(seen, push, self.motion, self.observation, self.gain, self.root)
        rest = turned[:, count:].reshape(-1, rows.shape[2])
        return np.concatenate([white.reshape(-1, rows.shape[2]), rest])


def rotation_to_seeing(errors: Array) -> Array | None:
    """[S, S'] (C, K, K) for rows that see slow errors of the observation like this (C, K, E), and of the state no more
    than these. None where E is not less than K.
    """
    if errors.shape[2] >= errors.shape[1]:
        return None
    return np.asarray(np.linalg.qr(errors, mode="complete").Q)
