"""Cubic Hermite interpolation of simulated runs at the instants that a recording saw.

    x(t_k + u h) = h00 x_k + (1 - h00) x_k+1 + h (h10 x'_k - u^2 (1 - u) x'_k+1),    0 <= u < 1
    h00 = (1 + 2 u)(1 - u)^2,    h10 = u (1 - u)^2

Its error is of order h^4 (de Boor 1978, A Practical Guide to Splines).
"""

from __future__ import annotations

import numpy as np

from affine_model.curvature import Array
from tentacle.compiled import njit


def at_times(t: Array, values: Array, rates: Array, times: Array) -> Array:
    """Values (T, n, B) and rates at even instants t (T,), interpolated at times (M, B) or (M, 1): shape (M, n, B).

    Before the first instant the values follow the tangent there. It is horizontal if the arm is held until its release.
    """
    return _cubic(values, rates, np.ascontiguousarray(times), float(t[0]), float(t[1] - t[0]))


@njit(cache=True, nogil=True)
def _cubic(values, rates, times, first, spacing):
    instants, size, lanes = values.shape
    own = times.shape[1] > 1  # each lane has its own times
    found = np.empty((times.shape[0], size, lanes))
    last = instants - 1 - 1e-9
    for m in range(times.shape[0]):
        for b in range(lanes if own else 1):
            place = min(max((times[m, b] - first) / spacing, 0.0), last)
            k = int(place)
            u = place - k
            h00, h10 = (1.0 + 2.0 * u) * (1.0 - u) ** 2, spacing * u * (1.0 - u) ** 2
            h11, early = spacing * u**2 * (1.0 - u), min(times[m, b] - first, 0.0)
            for i in range(size):
                for lane in range(b, b + 1 if own else lanes):
                    start, end = values[k, i, lane], values[k + 1, i, lane]
                    bent = h10 * rates[k, i, lane] - h11 * rates[k + 1, i, lane]
                    found[m, i, lane] = h00 * start + (1.0 - h00) * end + bent + early * rates[0, i, lane]
    return found
