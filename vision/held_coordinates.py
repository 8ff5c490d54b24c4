"""A fit holds its highest coordinates at zero: its covariance, and a factor for the error that this makes."""

from __future__ import annotations

import numpy as np

from tentacle.signals import Array


def held_covariance(covariance: Array, rows: list[int], gain: Array, tau: float) -> Array:
    """(1 - K H) C (1 - K H)' + K R K' (Bucy and Joseph 1968): never negative, also where a coordinate is not seen.

    covariance (T, K, K) before; rows: the coordinates that H picks, the offset first, whose spread is tau [rad], and
    then those held at zero; gain (T, K, R).
    """
    rest = np.eye(covariance.shape[1]) - np.zeros_like(covariance)
    rest[:, :, rows] -= gain
    told = gain[:, :, :1] * tau
    return np.asarray(rest @ covariance @ np.swapaxes(rest, 1, 2) + told @ np.swapaxes(told, 1, 2), dtype=float)


def left_out(evidence: dict[int, float], fitted: int, chosen: int) -> float:
    """Factor on the variance of x for the coordinates above the chosen order.

    Their excess over noise is an error, of a coordinate left out or of the edges. Above the highest fitted one nothing
    is known: the first term left out of a series is taken to be as large as the last one kept.
    """
    if chosen < fitted:
        return max(evidence.get(chosen, 0.0) / (fitted - chosen), 1.0)
    return max(evidence.get(chosen - 1, 0.0), 1.0)
