"""Weak-form identification: the equations of motion weighted with bumps in time, so that accelerations are never
needed.

int psi (M u'' - F) dt = int (-psi' M u' - psi (M' u' + F)) dt, since psi vanishes at both ends. Messenger and Bortz
2021.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from affine_model.arm import Arm, active_effects
from affine_model.curvature import Array
from affine_model.dynamics import Instant, balance
from inference.measured_motion import MeasuredCourse, MeasuredMotion, measured_motion, memory_along
from tentacle.errors import InputError

STEEPNESS = 6  # psi = (1 - x^2)^6: smooth enough that the trapezium rule is exact to 1e-6 on 15 samples
MASS_RATE_STEP = 1e-5  # s: step along the motion for M' u'


def bumps(t: Array, width: float, overlap: int = 4) -> tuple[Array, Array]:
    """psi and its derivative (W, T): bumps of `width` seconds, `overlap` of them over every instant, with integration
    weights.

    InputError where the record is shorter than two bumps, or a bump has fewer than 8 samples.
    """
    span = t[-1] - t[0]
    if width * 2.0 > span or np.median(np.diff(t)) * 8.0 > width:
        raise InputError(
            f"{width} s is not usable", field="width", expected="at least 8 samples, at most half the record"
        )
    middles = np.arange(t[0] + 0.5 * width, t[-1] - 0.5 * width + 1e-12, width / overlap)
    x = (t[None, :] - middles[:, None]) / (0.5 * width)
    inside = np.clip(1.0 - x**2, 0.0, None)
    weights = np.gradient(t)
    slope = -2.0 * STEEPNESS * x * inside ** (STEEPNESS - 1) / (0.5 * width)
    return inside**STEEPNESS * weights, slope * weights


def weak_residual(arm: Arm, parameters: Array, motion: MeasuredMotion, psi: Array, psi_rate: Array) -> Array:
    """Weighted residuals (W, n) [N m s] on the paper's coordinates; psi, psi_rate (W, T) as from bumps."""
    n, effects, times = arm.order, active_effects(parameters), motion.t[:, None]
    memory = memory_along(arm, parameters, motion)
    u, u_rate = motion.u, motion.u_rate
    here = balance(arm, effects, parameters, u, u_rate, Instant(times, memory))
    ahead = balance(arm, effects, parameters, u + MASS_RATE_STEP * u_rate, u_rate, Instant(times, memory)).mass_matrix
    behind = balance(arm, effects, parameters, u - MASS_RATE_STEP * u_rate, u_rate, Instant(times, memory)).mass_matrix
    momentum = np.einsum("tij,tj->ti", here.mass_matrix, u_rate)[:, :n]
    turning = np.einsum("tij,tj->ti", (ahead - behind) / (2.0 * MASS_RATE_STEP), u_rate)[:, :n]
    weak = -psi_rate @ momentum - psi @ (turning + here.force[:, :n])
    return weak @ arm.from_monomial


@dataclass(frozen=True)
class Bumps:
    """Weights in time: bumps of `width` [s], about half the shortest period that matters, `overlap` of them over every
    instant."""

    width: float
    overlap: int = 4


def weak_system(arm: Arm, course: MeasuredCourse, weights: Bumps, *, window: int = 7) -> Callable[[Array], Array]:
    """The weighted residual (N,) of these curvatures as a function of the parameters (R,).

    Rates are still smoothed over `window` samples. Overlapping bumps are not independent: see fit_linear.
    """
    motion = measured_motion(arm, course.t, course.q, course.base, q_rate=course.q_rate, window=window)
    psi, psi_rate = bumps(course.t, weights.width, weights.overlap)
    return lambda vector: weak_residual(arm, vector, motion, psi, psi_rate).ravel()
