"""How far an arm's shape and its rate go in a recording, without the noise of its frames.

    x_t ~ N(x, N_t^-1),   x_k ~ N(0, tau_k^2),   tau by expectation and maximisation (Dempster, Laird and Rubin 1977)

An initial state is one of the motion's states. Its prior has this spread, so that a coordinate which a noisy frame
leaves open by radians begins where the motion may be.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from affine_model.curvature import Array
from inference.observation import POSE, ShapeObservation

APART = 4  # frames between the two shapes of a rate
FRAMES, ROUNDS = 300, 50  # that are used, evenly spread; of expectation and maximisation
LEAST_SHAPE, LEAST_RATE = 1e-3, 0.01  # rad, rad/s: an arm at rest may be bent and may move by this


def spread(value: Array, information: Array) -> Array:
    """tau (K,) of values (T, K) whose information matrices are (T, K, K)."""
    pull = np.einsum("tkl,tl->tk", information, value)
    variance = np.ones(value.shape[1]) * max(float(np.mean(value**2)), 1e-12)
    for _ in range(ROUNDS):
        open_left = np.linalg.inv(information + np.diag(1.0 / variance))
        mean = np.einsum("tkl,tl->tk", open_left, pull)
        variance = np.mean(mean**2 + np.diagonal(open_left, axis1=1, axis2=2), axis=0)
    return np.sqrt(variance)


def _information(observation: ShapeObservation, frames: NDArray[np.intp]) -> Array:
    """Information matrices (F, K, K) of the coordinates in these frames, the pose marginalised.

    The pose stands first in the triangular root: without its rows this is the shape's.
    """
    root = observation.root[frames, POSE:, POSE:]
    return np.swapaxes(root, 1, 2) @ root


def likely_shapes(observation: ShapeObservation, frames: NDArray[np.intp], tau: Array) -> Array:
    """The likeliest coordinates (F, K) of these frames [rad] where each has the spread tau (K,) about 0."""
    information = _information(observation, frames)
    pull = np.einsum("tkl,tl->tk", information, observation.coefficients[frames, POSE:])
    return np.linalg.solve(information + np.diag(tau**-2.0), pull[..., None])[..., 0]


def motion_spread(observation: ShapeObservation) -> tuple[Array, Array]:
    """Spread (K,) [rad] of the Legendre coordinates and (K,) [rad/s] of their rates; empty for too few frames."""
    good = np.flatnonzero(observation.seen)
    if good.size <= APART:
        return np.zeros(0), np.zeros(0)
    z, t, information = observation.coefficients[good, POSE:], observation.t[good], _information(observation, good)
    apart = t[APART:] - t[:-APART]
    rates, between = (z[APART:] - z[:-APART]) / apart[:, None], apart[:, None, None] ** 2 / 2.0
    every = slice(None, None, max(1, good.size // FRAMES))
    shape = spread(z[every], information[every])
    rate = spread(rates[every], (information[:-APART] * between)[every])
    return shape + LEAST_SHAPE, rate + LEAST_RATE
