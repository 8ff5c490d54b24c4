"""Fig. 4: each coordinate averaged over the periods of the base's motion, with its spread."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tentacle.errors import InputError
from tentacle.signals import Array, ShapeTrack

LEAST_FRAMES = 3  # in a phase bin that is to have a spread


@dataclass(frozen=True)
class PeriodAverage:
    """phase (B,) in 0 to 1; mean, spread (B, K) [rad] of [offset, q1 ..]; count (B,) frames. NaN where too few."""

    phase: Array
    mean: Array
    spread: Array
    count: Array


def period_average(shape: ShapeTrack, frequency: float, bins: int = 50) -> PeriodAverage:
    """Average the accepted frames over periods of 1 / frequency [s]. spread is the standard deviation over periods."""
    if not (np.isfinite(frequency) and frequency > 0):
        raise InputError(f"{frequency!r} is not usable", field="frequency", expected="a positive number of Hz")
    kept = shape.accepted
    index = np.minimum((np.mod(shape.t[kept] * frequency, 1.0) * bins).astype(int), bins - 1)
    values = shape.coefficients[kept]
    mean = np.full((bins, values.shape[1]), np.nan)
    spread = mean.copy()
    count = np.bincount(index, minlength=bins)
    for k in range(bins):
        if count[k] >= LEAST_FRAMES:
            mean[k], spread[k] = values[index == k].mean(axis=0), values[index == k].std(axis=0, ddof=1)
    return PeriodAverage((np.arange(bins) + 0.5) / bins, mean, spread, count.astype(float))
