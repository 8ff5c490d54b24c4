"""The paper's identification (eq. 18-19): pseudo-inverse regression on numerically differentiated curvatures.

    delta = Y(q, q') pi,        pi = pinv(Y) delta

This is the method of the paper, kept as a baseline. Noise in q enters the regressors (q, q', |v| v) and the
accelerations, so the estimate is biased, and more data do not help: 1 mrad of noise at 60 samples a second already
moves damping by tens of per cent (tests/inference/test_regression.py). The trajectory fit has no such bias.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from affine_model.arm import Arm, active_effects
from affine_model.curvature import Array
from affine_model.dynamics import Instant, balance
from inference.linear_fit import LinearFit, ParameterName, fit_linear
from inference.measured_motion import MeasuredCourse, MeasuredMotion, measured_motion, memory_along


def motion_residual(arm: Arm, parameters: Array, motion: MeasuredMotion, torque: Array | None = None) -> Array:
    """delta - Y pi of eq. 18 on the paper's coordinates, (T, n) [N m];
    with the servo's torque (T,) [N m] also its row, (T, n + 1).
    """
    memory = memory_along(arm, parameters, motion)
    found = balance(
        arm, active_effects(parameters), parameters, motion.u, motion.u_rate, Instant(motion.t[:, None], memory)
    )
    missing = np.einsum("tij,tj->ti", found.mass_matrix, motion.u_acceleration) - found.force
    curvatures = missing[:, : arm.order] @ arm.from_monomial
    if torque is None:
        return curvatures
    return np.concatenate([curvatures, (missing[:, arm.order] - torque)[:, None]], axis=1)


def regression(
    arm: Arm, parameters: Array, free: Sequence[ParameterName], course: MeasuredCourse, *, window: int = 7
) -> LinearFit:
    """Fit the free parameters to a measured course, by eq. 19.

    parameters (R,): the values of all others. Where the servo's torque is known, eq. 18's third row is used. window:
    samples that each derivative's local quartic spans; the first and last half window are left out. InputError where
    the samples cannot be differentiated.
    """
    motion = measured_motion(arm, course.t, course.q, course.base, q_rate=course.q_rate, window=window)
    inside = slice(window // 2, course.t.size - window // 2)

    def residual(vector: Array) -> Array:
        return motion_residual(arm, vector, motion, course.torque)[inside].ravel()

    return fit_linear(residual, parameters, free)
