"""What a sensor reads, at the instants of the pictures.

Where it is read more often than pictures are taken, each frame has the value of a parabola through the readings around
it; where less often, only the frames next to a reading have one.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import PchipInterpolator

from affine_model.curvature import Array

FEWEST_READINGS = 5  # in a frame's time, for a parabola through them


def at_frames(t: Array, read_at: Array, values: Array, widest: float = np.inf) -> tuple[Array, float]:
    """Readings (N,) at read_at (N,) as values (T,) at the frames t (T,), NaN where there is none; and the share of a
    reading's standard deviation that such a value has. widest [s]: over which readings are taken together.
    """
    there = np.isfinite(values)
    read_at, values = read_at[there], values[there]
    found = np.full(t.size, np.nan)
    interval = min(float(np.median(np.diff(t))), widest)
    if read_at.size < 2:
        return found, 1.0
    if interval < FEWEST_READINGS * float(np.median(np.diff(read_at))):
        middles = 0.5 * (t[1:] + t[:-1])
        near = np.unique(np.searchsorted(middles, read_at[read_at <= t[-1]], side="right"))
        near = near[(t[near] >= read_at[0]) & (t[near] <= read_at[-1])]
        found[near] = PchipInterpolator(read_at, values)(t[near])
        return found, 1.0
    begin, end = np.searchsorted(read_at, t - 0.5 * interval), np.searchsorted(read_at, t + 0.5 * interval)
    shares = []
    for k in np.flatnonzero(end - begin >= FEWEST_READINGS):
        away = (read_at[begin[k] : end[k]] - t[k]) / interval
        weights = np.linalg.pinv(np.vander(away, 3))[2]
        found[k] = weights @ values[begin[k] : end[k]]
        shares.append(np.linalg.norm(weights))
    return found, float(np.median(shares)) if shares else 1.0
