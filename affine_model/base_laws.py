"""What the servo effects do to the base motion: tables (3, S) of theta and its derivatives at even steps."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.signal import cont2discrete, lfilter, lfiltic, ss2tf

from affine_model.curvature import Array
from tentacle.compiled import njit

BRIEF = 0.1  # steps: an oscillation of a shorter time moves nothing in a step
PLAY_SMOOTHING = 0.006  # s: the play operator's corners are rounded over this time, so that theta has two derivatives


def low_pass(table: Array, step: float, delay: float, period: float) -> Array:
    """Each row of a table (3, S) behind (period / 2 pi)^2 y'' + delay y' + y = u, started in its steady state.

    Exact for an input that is linear between samples.
    """
    if delay <= 0.0 and period <= 2.0 * np.pi * BRIEF * step:
        return table
    inertia = (period / (2.0 * np.pi)) ** 2
    if inertia > (BRIEF * step) ** 2:
        system = np.array([[0.0, 1.0], [-1.0 / inertia, -delay / inertia]]), np.array([[0.0], [1.0 / inertia]])
        seen = np.array([[1.0, 0.0]])
    else:
        system, seen = (np.array([[-1.0 / delay]]), np.array([[1.0 / delay]])), np.array([[1.0]])
    discrete: Any = cont2discrete((*system, seen, np.zeros((1, 1))), step, method="foh")
    numerator, denominator = cast("Any", ss2tf)(*discrete[:4])
    b, a = np.asarray(numerator[0]), np.asarray(denominator)
    rows = []
    for row, rate in zip(table, (*table[1:], np.gradient(table[2], step)), strict=True):
        before = row[0] - step * rate[0] * np.arange(1, a.size)
        zi = lfiltic(b, a, before - delay * rate[0], before)
        rows.append(lfilter(b, a, row, zi=zi)[0])
    return np.array(rows)


@njit(cache=True, nogil=True)
def play_operator(angle: Array, play: float) -> Array:
    """Output (S,) of a gear with total play [rad]: it follows the input once the play is used up."""
    half = 0.5 * play
    output = np.empty_like(angle)
    position = angle[0]
    for k, value in enumerate(angle):
        position = min(max(position, value - half), value + half)
        output[k] = position
    return output


def with_play(table: Array, step: float, play: float) -> Array:
    """theta behind a gear with play, and its derivatives. Only the difference to the input is smoothed."""
    if play <= 0.0:
        return table
    lost = gaussian_filter1d(play_operator(table[0], play) - table[0], PLAY_SMOOTHING / step, mode="nearest")
    rate = np.gradient(lost, step)
    return table + np.array([lost, rate, np.gradient(rate, step)])
