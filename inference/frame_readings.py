"""What a sensor reads, at the instants of the pictures.

Where it is read more often than pictures are taken, each frame has the value of a polynomial through the readings
around it; where less often, only the frames next to a reading have one, of a curve through all readings.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator

from affine_model.curvature import Array
from tentacle.signals import RAREST_READING

SPARE_READINGS = 3  # more readings than the polynomial's degree, at least


@dataclass(frozen=True)
class Taking:
    """How readings are taken together: the polynomial's degree, the longest time [s] that it covers, the curve through
    readings that are too rare for it, and the longest time [s] between readings that the signal allows.
    """

    degree: int
    longest: float
    curve: Callable[[Array, Array], Any]
    rarest: float


SLOW = Taking(2, np.inf, PchipInterpolator, np.inf)
# An acceleration has higher harmonics than a shape. In the 1.6 m/s^2 (rms) of a tip in water a quartic errs over .03 s
# by .001 m/s^2 (rms), over .05 s by .0035; a cubic spline through readings at 100 Hz by .003, at 50 Hz by .011.
FAST = Taking(4, 0.03, CubicSpline, RAREST_READING)


def at_frames(t: Array, read_at: Array, values: Array, taking: Taking = SLOW) -> tuple[Array, float]:
    """Readings (N,) at read_at (N,) as values (T,) at the frames t (T,), NaN where there is none; and the share of a
    reading's standard deviation that such a value has.
    """
    there = np.isfinite(values)
    read_at, values = read_at[there], values[there]
    found = np.full(t.size, np.nan)
    fewest = taking.degree + SPARE_READINGS
    if read_at.size < 2:
        return found, 1.0
    interval = min(float(np.median(np.diff(t))), taking.longest)
    if interval < fewest * float(np.median(np.diff(read_at))):
        middles = 0.5 * (t[1:] + t[:-1])
        near = np.unique(np.searchsorted(middles, read_at[read_at <= t[-1]], side="right"))
        near = near[(t[near] >= read_at[0]) & (t[near] <= read_at[-1])]
        found[near] = taking.curve(read_at, values)(t[near])
        return found, 1.0
    begin, end = np.searchsorted(read_at, t - 0.5 * interval), np.searchsorted(read_at, t + 0.5 * interval)
    shares = []
    for k in np.flatnonzero(end - begin >= fewest):
        away = (read_at[begin[k] : end[k]] - t[k]) / interval
        weights = np.linalg.pinv(np.vander(away, taking.degree + 1))[-1]
        found[k] = weights @ values[begin[k] : end[k]]
        shares.append(np.linalg.norm(weights))
    return found, float(np.median(shares)) if shares else 1.0
