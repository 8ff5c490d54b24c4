"""The Kalman filter's two loops, compiled: gains along a recording, and columns of residuals whitened with them."""

from __future__ import annotations

import numpy as np

from tentacle.compiled import njit


@njit(cache=True, nogil=True)
def gains_along(transition, push, added, start, observation):
    """Gain (C, N, K), inverse Cholesky root (C, K, K) of every innovation, and half its log determinant, of a state
    with that transition (N, N), its last J entries pushing the others by push (C, N, J), added covariance
    (N, N), covariance at the start, seen by observation (C, K, N) in unit noise. A cell whose rows are 0 tells nothing.
    """
    cells, count, size = observation.shape
    gain = np.zeros((cells, size, count))
    root = np.zeros((cells, count, count))
    covariance = start.copy()
    constant = size - push.shape[2]
    forward = transition.copy()
    half = 0.0
    for k in range(cells):
        if k > 0:
            forward[:, constant:] = transition[:, constant:] + push[k - 1]
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
def whitened_along(rows, transition, push, observation, gain, root):
    """Columns of rows (C, K, B), each filtered by the same gains: independent rows of unit variance (C, K, B)."""
    cells, _, columns = rows.shape
    constant = transition.shape[0] - push.shape[2]
    state = np.zeros((transition.shape[0], columns))
    white = np.empty_like(rows)
    for k in range(cells):
        if k > 0:
            state = transition @ state + push[k - 1] @ state[constant:]
        error = rows[k] - observation[k] @ state
        white[k] = root[k] @ error
        state = state + gain[k] @ error
    return white
