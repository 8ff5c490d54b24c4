"""Many gaits at once: the table of base motions that the batch kernel takes, for a batch of eq. 20 parameters.

Same definition as tentacle.gait.Gait (its constants are used here, and a test compares both). Every harmonic is a
phasor that is turned by a fixed angle a step: no sine is computed inside the loop, and the batch is innermost so that
it vectorises.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from affine_model.curvature import Array
from tentacle.compiled import njit, prange
from tentacle.gait import COEFFICIENT, MULTIPLE, TERM, Gait, harmonic_weights

_BLOCK = 16
_RENEW = 512  # steps after which phasors are computed anew, so that rounding stays below 1e-13
FAST = {"contract", "reassoc", "nsz", "arcp"}


class Harmonics(NamedTuple):
    """strength [rad], omega [rad/s] and phase [rad] of each harmonic, (H, B) each."""

    strength: Array
    omega: Array
    phase: Array


@njit(cache=True, parallel=True, fastmath=FAST, error_model="numpy")
def _fill(harmonics: Harmonics, start, step, table, peaks):
    terms, count = harmonics.strength.shape
    steps = table.shape[1]
    for block in prange((count + _BLOCK - 1) // _BLOCK):
        first = block * _BLOCK
        width = min(_BLOCK, count - first)
        sine = np.empty((terms, _BLOCK))
        cosine = np.empty((terms, _BLOCK))
        turn_sine = np.empty((terms, _BLOCK))
        turn_cosine = np.empty((terms, _BLOCK))
        weight = np.zeros((terms, _BLOCK))
        rate = np.zeros((terms, _BLOCK))
        used = np.empty(terms, np.int64)
        uses = 0
        for h in range(terms):
            largest = 0.0
            for b in range(width):
                weight[h, b] = harmonics.strength[h, first + b]
                rate[h, b] = harmonics.omega[h, first + b]
                turn_sine[h, b] = np.sin(rate[h, b] * step)
                turn_cosine[h, b] = np.cos(rate[h, b] * step)
                largest = max(largest, abs(weight[h, b]))
            if largest > 0.0:
                used[uses] = h
                uses += 1
        for k in range(steps):
            if k % _RENEW == 0:
                for index in range(uses):
                    h = used[index]
                    for b in range(width):
                        angle = rate[h, b] * (start + k * step) + harmonics.phase[h, first + b]
                        sine[h, b] = np.sin(angle)
                        cosine[h, b] = np.cos(angle)
            theta = np.zeros(_BLOCK)
            theta_rate = np.zeros(_BLOCK)
            theta_acceleration = np.zeros(_BLOCK)
            for index in range(uses):
                h = used[index]
                for b in range(_BLOCK):
                    wave = weight[h, b] * sine[h, b]
                    theta[b] += wave
                    theta_rate[b] += weight[h, b] * rate[h, b] * cosine[h, b]
                    theta_acceleration[b] -= wave * rate[h, b] * rate[h, b]
                    turned = sine[h, b] * turn_cosine[h, b] + cosine[h, b] * turn_sine[h, b]
                    cosine[h, b] = cosine[h, b] * turn_cosine[h, b] - sine[h, b] * turn_sine[h, b]
                    sine[h, b] = turned
            for b in range(width):
                table[0, k, first + b] = theta[b]
                table[1, k, first + b] = theta_rate[b]
                table[2, k, first + b] = theta_acceleration[b]
                peaks[0, first + b] = max(peaks[0, first + b], abs(theta[b]))
                peaks[1, first + b] = max(peaks[1, first + b], abs(theta_rate[b]))
                peaks[2, first + b] = max(peaks[2, first + b], abs(theta_acceleration[b]))


def gait_tables(alpha: Array, steps: int, step: float, bandwidth: float, start: float = 0.0) -> tuple[Array, Array]:
    """Base motions of gaits alpha (9, B) at start + k step, k = 0 .. steps - 1 [s].

    Returns the table (3, steps, B) of theta and its first two derivatives [rad, s], and their largest magnitudes (3,
    B).
    """
    alpha = np.ascontiguousarray(alpha, dtype=float)
    amplitude, omega, phase = alpha[0:3], alpha[3:6], alpha[6:9]
    weights = harmonic_weights(omega / (2.0 * np.pi), bandwidth)
    strength = amplitude[TERM] * COEFFICIENT[:, None] * weights
    table, peaks = np.empty((3, steps, alpha.shape[1])), np.zeros((3, alpha.shape[1]))
    _fill(Harmonics(strength, MULTIPLE[:, None] * omega[TERM], phase[TERM]), start, step, table, peaks)
    return table, peaks


def gait_of(alpha: Array, bandwidth: float) -> Gait:
    """One gait (9,) as a waveform."""
    return Gait(tuple(alpha.tolist()), bandwidth)
