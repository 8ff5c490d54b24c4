"""The compiled loops of the Kalman filter: gains along a recording, whitening of columns of residuals, and smoothing.

    x_k+1 = F_k x_k + w_k,  cov(w_k) = Q;    y_k = H_k x_k + v_k,  cov(v_k) = 1

F_k is F, but for what the latent forces do: they are as large as the motion is then (inference.latent_force).
"""

from __future__ import annotations

import numpy as np

from tentacle.compiled import njit

TINY = 1e-10  # of a variance: against rounding


@njit(cache=True, nogil=True)
def gains_along(motion, added, start, observation):
    """Gain (C, N, K), inverse Cholesky root (C, K, K) of every innovation, and half the log determinant.

    motion: F (N, N); forced (M, n), what n latent forces of unit size do to the first M states; envelope (C,), their
    size in each cell; first, their place in the state, behind their n rates and a pair more: a value and its rate. The
    states after them remember each itself alone. added (N, N):
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
    cells, count, columns = rows.shape
    moved, core = forced.shape[0], first + forced.shape[1]
    by_arm = np.ascontiguousarray(transition[:moved, :moved])
    by_others = np.ascontiguousarray(transition[:moved, first - 2 : core])
    state = np.zeros((transition.shape[0], columns))
    arm, more, known = np.empty((moved, columns)), np.empty((moved, columns)), np.empty(state.shape)
    error, white = np.empty((count, columns)), np.empty_like(rows)
    for k in range(cells):
        if k > 0:
            by_others[:, 2:] = envelope[k - 1] * forced
            np.dot(by_arm, state[:moved], arm)
            np.dot(by_others, state[first - 2 : core], more)
            _remember(transition, state, moved, first)
            for i in range(moved):
                for b in range(columns):
                    state[i, b] = arm[i, b] + more[i, b]
            if push.shape[0] > 0:
                state[:moved] -= push[k - 1]
        np.dot(observation[k], state, error)
        for i in range(count):
            for b in range(columns):
                error[i, b] = rows[k, i, b] - error[i, b]
        np.dot(root[k], error, white[k])
        np.dot(gain[k], error, known)
        for i in range(state.shape[0]):
            for b in range(columns):
                state[i, b] += known[i, b]
    return white


@njit(cache=True, nogil=True)
def _remember(transition, state, moved, first):
    """The states (N, B) that nothing else moves, from one cell to the next: pairs of a value and its rate (the latent
    forces f, f' at first and moved; the base's error b, b' before first), and those that remember themselves alone.
    """
    forces = first - 2 - moved
    for pair in range(forces + 1):
        value, rate = (first + pair, moved + pair) if pair < forces else (first - 2, first - 1)
        for b in range(state.shape[1]):
            before, slope = state[value, b], state[rate, b]
            state[value, b] = transition[value, value] * before + transition[value, rate] * slope
            state[rate, b] = transition[rate, value] * before + transition[rate, rate] * slope
    for i in range(first + forces, state.shape[0]):
        for b in range(state.shape[1]):
            state[i, b] *= transition[i, i]


@njit(cache=True, nogil=True)
def _parts(transition, core):
    """The transition among the first states (core, core), and what each of the others keeps of itself."""
    return np.ascontiguousarray(transition[:core, :core]), np.diag(transition)[core:].copy()


@njit(cache=True, nogil=True)
def filtered_along(rows, seen, transition, added, start):
    """The state's mean (C, N) and covariance (C, N, N) in every cell given it and those before; log likelihood [nats].

    rows (C, K): what is seen, of unit noise; seen (C, K, N): H; transition, added and start (N, N): F, Q and the
    covariance before the first cell, where the mean is 0.
    """
    cells, count = rows.shape
    size = start.shape[0]
    means, covariances = np.zeros((cells, size)), np.zeros((cells, size, size))
    mean, covariance, likelihood = np.zeros(size), start.copy(), 0.0
    turned = np.ascontiguousarray(transition.T)
    for k in range(cells):
        if k > 0:
            mean, covariance = transition @ mean, transition @ covariance @ turned + added
        cross = covariance @ np.ascontiguousarray(seen[k].T)
        factor = np.linalg.cholesky(seen[k] @ cross + np.eye(count))
        inverse = np.linalg.inv(factor)
        error = inverse @ (rows[k] - seen[k] @ mean)
        scaled = cross @ np.ascontiguousarray(inverse.T)
        likelihood -= 0.5 * np.sum(error**2) + np.sum(np.log(np.diag(factor)))
        mean = mean + scaled @ error
        covariance = covariance - scaled @ np.ascontiguousarray(scaled.T)
        covariance = 0.5 * (covariance + covariance.T)
        means[k], covariances[k] = mean, covariance
    return means, covariances, likelihood


@njit(cache=True, nogil=True)
def smoothed_along(means, covariances, transition, added):
    """The state's mean and standard deviation (C, N) in every cell given all, from those of the filter."""
    cells, size = means.shape
    smooth, deviation = np.zeros((cells, size)), np.zeros((cells, size))
    turned = np.ascontiguousarray(transition.T)
    mean, covariance = means[-1], covariances[-1]
    for k in range(cells - 1, -1, -1):
        if k < cells - 1:
            own = covariances[k]
            ahead = transition @ own
            uncertain = ahead @ turned + added
            back = np.ascontiguousarray(np.linalg.solve(uncertain + TINY * np.diag(np.diag(uncertain)), ahead).T)
            mean = means[k] + back @ (mean - transition @ means[k])
            covariance = own + back @ (covariance - uncertain) @ np.ascontiguousarray(back.T)
        smooth[k], deviation[k] = mean, np.sqrt(np.maximum(np.diag(covariance), 0.0))
    return smooth, deviation
