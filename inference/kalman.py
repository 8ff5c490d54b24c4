"""The two compiled loops of the Kalman filter: gains along a recording, and whitening of columns of residuals.

    x_k+1 = F_k x_k + w_k,  cov(w_k) = Q;    y_k = H_k x_k + v_k,  cov(v_k) = 1

F_k is F, but for what the latent forces do: they are as large as the motion is then (inference.latent_force).
"""

from __future__ import annotations

import numpy as np

from tentacle.compiled import njit


@njit(cache=True, nogil=True)
def gains_along(motion, added, start, observation):
    """Gain (C, N, K), inverse Cholesky root (C, K, K) of every innovation, and half the log determinant.

    motion: F (N, N); forced (M, n), what n latent forces of unit size do to the first M states; envelope (C,), their
    size in each cell; first, their place in the state. The states after them remember each itself alone. added (N, N):
    Q; start (N, N): covariance at the start; observation (C, K, N): H. A cell whose rows are 0 adds no information.
    """
    transition, forced, envelope, first = motion
    cells, count, size = observation.shape
    moved, core = forced.shape[0], first + forced.shape[1]
    among, alone = _parts(transition, core)
    gain = np.zeros((cells, size, count))
    root = np.zeros((cells, count, count))
    covariance = start.copy()
    half = 0.0
    for k in range(cells):
        if k > 0:
            among[:moved, first:core] = envelope[k - 1] * forced
            ahead = among @ covariance[:core]
            both = np.ascontiguousarray(ahead[:, :core]) @ np.ascontiguousarray(among.T)
            for i in range(size):
                for j in range(i + 1):
                    if i < core:
                        moved_on = both[i, j]
                    elif j < core:
                        moved_on = ahead[j, i] * alone[i - core]
                    else:
                        moved_on = covariance[i, j] * alone[i - core] * alone[j - core]
                    covariance[i, j] = covariance[j, i] = moved_on + added[i, j]
        rows = observation[k]
        cross = covariance @ np.ascontiguousarray(rows.T)
        factor = np.linalg.cholesky(rows @ cross + np.eye(count))
        inverse = np.linalg.inv(factor)
        root[k] = inverse
        half += np.sum(np.log(np.diag(factor)))
        scaled = cross @ np.ascontiguousarray(inverse.T)
        gain[k] = scaled @ inverse
        known = scaled @ np.ascontiguousarray(scaled.T)
        for i in range(size):
            for j in range(i + 1):
                covariance[i, j] -= known[i, j]
                covariance[j, i] = covariance[i, j]
    return gain, root, half


@njit(cache=True, nogil=True)
def whitened_along(rows, push, motion, observation, gain, root):
    """Columns of rows (C, K, B), each filtered by the same gains: independent rows of unit variance (C, K, B).

    motion: as in gains_along. push (C, M, B): what
    moves the first M states of each column from each cell to the next and the filter does not know; (0, M, B): nothing.
    """
    transition, forced, envelope, first = motion
    cells, _, columns = rows.shape
    moved, core = forced.shape[0], first + forced.shape[1]
    among, alone = _parts(transition, core)
    state = np.zeros((transition.shape[0], columns))
    white = np.empty_like(rows)
    for k in range(cells):
        if k > 0:
            force = envelope[k - 1] * (forced @ state[first:core])
            state[:core] = among @ state[:core]
            state[core:] *= alone.reshape(-1, 1)
            state[:moved] += force
            if push.shape[0] > 0:
                state[:moved] -= push[k - 1]
        error = rows[k] - observation[k] @ state
        white[k] = root[k] @ error
        state += gain[k] @ error
    return white


@njit(cache=True, nogil=True)
def _parts(transition, core):
    """The transition among the first states (core, core), and what each of the others keeps of itself."""
    return np.ascontiguousarray(transition[:core, :core]), np.diag(transition)[core:].copy()
