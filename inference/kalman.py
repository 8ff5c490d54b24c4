"""The two compiled loops of the Kalman filter: gains along a recording, and whitening of columns of residuals."""

from __future__ import annotations

import numpy as np

from tentacle.compiled import njit


@njit(cache=True, nogil=True)
def gains_along(motion, added, start, observation):
    """Gain (C, N, K), inverse Cholesky root (C, K, K) of every innovation, and half the log determinant.

        x_k+1 = (transition + [0, pushed push_k]) x_k + w,  cov(w) = added;    y_k = observation_k x_k + v,  cov(v) = 1

    motion: transition (N, N); pushed (N, n), what a force does to the state; push (C, n, J), forces of the state's last
    J entries. added (N, N); start (N, N): covariance at the start; observation (C, K, N). A cell whose rows are 0 adds
    no information.
    """
    transition, pushed, push = motion
    cells, count, size = observation.shape
    gain = np.zeros((cells, size, count))
    root = np.zeros((cells, count, count))
    covariance = start.copy()
    constant = size - push.shape[2]
    forward = transition.copy()
    half = 0.0
    for k in range(cells):
        if k > 0:
            forward[:, constant:] = transition[:, constant:] + pushed @ push[k - 1]
            covariance = forward @ covariance @ np.ascontiguousarray(forward.T) + added
        rows = observation[k]
        cross = covariance @ np.ascontiguousarray(rows.T)
        innovation = rows @ cross + np.eye(count)
        factor = np.linalg.cholesky(innovation)
        inverse = np.linalg.inv(factor)
        root[k] = inverse
        half += np.sum(np.log(np.diag(factor)))
        scaled = cross @ np.ascontiguousarray(inverse.T)
        gain[k] = scaled @ inverse
        covariance = covariance - scaled @ np.ascontiguousarray(scaled.T)
        covariance = 0.5 * (covariance + covariance.T)
    return gain, root, half


@njit(cache=True, nogil=True)
def whitened_along(rows, motion, observation, gain, root):
    """Columns of rows (C, K, B), each filtered by the same gains: independent rows of unit variance (C, K, B)."""
    transition, pushed, push = motion
    cells, _, columns = rows.shape
    constant = transition.shape[0] - push.shape[2]
    state = np.zeros((transition.shape[0], columns))
    white = np.empty_like(rows)
    for k in range(cells):
        if k > 0:
            state = transition @ state + pushed @ (push[k - 1] @ state[constant:])
        error = rows[k] - observation[k] @ state
        white[k] = root[k] @ error
        state = state + gain[k] @ error
    return white
