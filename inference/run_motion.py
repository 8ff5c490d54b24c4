"""The motion of simulated runs at the instants that a recording saw.

    x''_k = 2 (x_k+1 - 2 x_k + x_k-1) / h^2 - (x'_k+1 - x'_k-1) / 2h

x and x' at even steps h determine x'' with an error of x^(6) h^4 / 360 (a compact difference: Collatz 1960, The
Numerical Treatment of Differential Equations). Between the steps x' and x'' are interpolated as x is
(inference.interpolate). The run's own error, of order h^2, is larger: at the step with which fits begin, 1/150 s,
the 1.5 m/s^2 (rms) of a tip in water are right to .004 m/s^2.
"""

from __future__ import annotations

import numpy as np

from affine_model.arm import Arm
from affine_model.curvature import Array
from affine_model.simulate import Batch
from inference.appearance import Motion
from inference.interpolate import at_times


def accelerations(values: Array, rates: Array, interval: float) -> Array:
    """Second derivatives (T, ...) of values with these rates (T, ...) at instants that lie `interval` [s] apart.

    At both ends: of the quintic through the three nearest values and rates.
    """
    found = np.empty_like(values)
    second = values[2:] - 2.0 * values[1:-1] + values[:-2]
    found[1:-1] = 2.0 * second / interval**2 - (rates[2:] - rates[:-2]) / (2.0 * interval)
    for end, inward in ((0, 1), (-1, -1)):
        x = [values[end + inward * k] for k in range(3)]
        v = [inward * rates[end + inward * k] for k in range(3)]
        found[end] = (-11.5 * x[0] + 8.0 * x[1] + 3.5 * x[2]) / interval**2 - (
            6.0 * v[0] + 8.0 * v[1] + v[2]
        ) / interval
    return found


def motion_at(arm: Arm, batch: Batch, times: Array, pull: Array) -> Motion:
    """The motion of an arm's batch at times (T, B) or (T, 1) [s]; pull (T, 2, B) as in Motion.

    Before the batch begins the arm is held, or moves on along its tangent: it is not accelerated.
    """
    before = (times < batch.t[0])[:, None]

    def both(values: Array, rates: Array) -> Array:
        second = accelerations(values, rates, float(batch.t[1] - batch.t[0]))
        third = np.gradient(second, batch.t, axis=0)
        found = at_times(batch.t, rates, second, times), at_times(batch.t, second, third, times)
        return np.stack([np.where(before, rates[:1], found[0]), np.where(before, 0.0, found[1])])

    q, theta = both(batch.q, batch.q_rate), both(batch.theta[:, None], batch.theta_rate[:, None])[:, :, 0]
    return Motion(q, theta + arm.root_turn(q, 2), pull)
