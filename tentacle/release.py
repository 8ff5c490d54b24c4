"""The time at which a held body was released, from its own path: it swings away about its later position of rest.

    |x(t) - x_held| = D sin^2(omega (t - t_r) / 2),   so   asin(sqrt(|x - x_held| / D)) = omega (t - t_r) / 2

D is the largest distance, half a period later. That line is fitted from the end of the noise up to SHARE of D. The
regression's standard error is that of the release; it is larger if a hand lets go over some frames, because the line is
then curved.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import median_abs_deviation

from tentacle.signals import Array

NOISE_DEVIATIONS = 5.0  # standard deviations of the held path: beyond them the body moves
SHARE = 0.3  # of the largest distance: beyond it damping and higher modes distort the line
FEWEST_LINE_FRAMES = 4  # frames of a line with a standard error


@dataclass(frozen=True)
class Release:
    """time [s] of the release and its standard deviation [s]."""

    time: float
    sd: float


def find_release(t: Array, path: Array) -> Release | None:
    """The release of a path (T, K) [m] that begins at rest, at times t (T,) [s]; None if it stays at rest."""
    reached = int(np.argmax(_distance(path, path[0]) > 0.5 * SHARE * _distance(path, path[0]).max()))
    held = path[: max(int(0.9 * reached) - FEWEST_LINE_FRAMES, 3)]
    away = _distance(path, np.median(held, axis=0))
    noise = 1.4826 * float(np.linalg.norm(median_abs_deviation(held, axis=0)))
    farthest = float(away.max())
    last = int(np.argmax(away > SHARE * farthest))
    if last < FEWEST_LINE_FRAMES or SHARE * farthest <= 2.0 * NOISE_DEVIATIONS * noise:
        return None
    begun = np.flatnonzero(away[:last] <= max(NOISE_DEVIATIONS * noise, 0.02 * farthest))
    first = min(int(begun[-1]) + 1 if begun.size else 0, last - FEWEST_LINE_FRAMES + 1)
    times, phase = t[first : last + 1], np.arcsin(np.sqrt(away[first : last + 1] / farthest))
    centred = times - times.mean()
    slope = float(centred @ phase / (centred @ centred))
    rest = phase - phase.mean() - slope * centred
    zero = float(times.mean() - phase.mean() / slope)
    deviation = np.sqrt(rest @ rest / max(times.size - 2, 1)) / abs(slope)
    spread = deviation * np.sqrt(1.0 / times.size + (zero - times.mean()) ** 2 / (centred @ centred))
    return Release(zero, max(float(spread), 0.25 * float(np.median(np.diff(t)))))


def _distance(path: Array, point: Array) -> Array:
    return np.linalg.norm(path - point, axis=1)
