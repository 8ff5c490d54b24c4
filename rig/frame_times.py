"""When a camera's pictures were taken, from when they arrived: a steady camera's own rhythm, without the line's jitter.

A picture's arrival is late by the line's delay, which varies by a millisecond or two. A tip at 0.3 m/s moves by half a
millimetre in that time. A camera takes its pictures at equal intervals of its own crystal:

    arrival_i = a + b n_i + jitter_i,  n_i whole numbers (a dropped picture leaves one out),

and least squares give a and b. Where a camera is not steady (its exposure changes with the light), the residuals do not
scatter about the line as a jitter does, and the arrivals stand as they are.
"""

from __future__ import annotations

import numpy as np

from tentacle.signals import Array

FEWEST = 60  # pictures, for a line that is better than the arrivals
LARGEST_JITTER = 0.2  # of the interval, standard deviation: a whole number is then rounded wrongly once in 80
ALIKE = 30  # pictures in a row; their mean residual is that of a jitter
SURE = 5.0  # standard errors by which such a mean may be off the line
CLIPPED = 3  # times that the line is fitted, each without the late ones of the time before
LATE, NORMAL = 4.0, 1.4826  # standard deviations beyond which a picture was late; one over the median of |rest|


def steadied(arrival: Array) -> Array:
    """Times (N,) [s] on the camera's own rhythm for arrivals (N,) [s]; the arrivals where it has none.

    Pictures that a busy computer took late count for nothing in the line.
    """
    if len(arrival) < FEWEST or np.any(np.diff(arrival) <= 0.0):
        return arrival
    steps = np.diff(arrival) / np.median(np.diff(arrival))
    number = np.concatenate([[0.0], np.cumsum(np.maximum(np.round(steps), 1.0))])
    usual, rest, line = np.ones(len(arrival), dtype=bool), arrival, (0.0, 0.0)
    for _ in range(CLIPPED):
        line = np.polyfit(number[usual], arrival[usual], 1)
        rest = arrival - np.polyval(line, number)
        usual = np.abs(rest - np.median(rest)) <= LATE * NORMAL * np.median(np.abs(rest - np.median(rest)))
    spread = float(rest[usual].std())
    rows = rest[usual][: np.count_nonzero(usual) // ALIKE * ALIKE].reshape(-1, ALIKE).mean(axis=1)
    steady = spread <= LARGEST_JITTER * line[0] and np.all(np.abs(rows) <= SURE * spread / np.sqrt(ALIKE))
    return np.asarray(np.polyval(line, number), dtype=float) if steady else arrival
