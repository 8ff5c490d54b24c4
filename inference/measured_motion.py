"""A measured motion prepared for regression: smoothed curvatures, their derivatives, base motion and memory."""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial

import numpy as np

from affine_model.arm import Arm, active_effects
from affine_model.curvature import Array
from affine_model.dynamics import advanced_memory, remembering
from tentacle.errors import InputError


@dataclass(frozen=True)
class MeasuredMotion:
    """t (T,) [s]; u, u_rate, u_acceleration (T, n + 2): Legendre curvatures, base angle, rail (zero),
    and derivatives.
    """

    t: Array
    u: Array
    u_rate: Array
    u_acceleration: Array


@dataclass(frozen=True)
class MeasuredCourse:
    """What was measured at t (T,) [s]: q (T, n) [rad], the base's angle and its two derivatives, base (3, T); where
    measured, rates q_rate (T, n) [rad/s] and the servo's torque (T,) [N m].
    """

    t: Array
    q: Array
    base: Array
    q_rate: Array | None = None
    torque: Array | None = None


def local_polynomials(t: Array, values: Array, window: int, degree: int = 4) -> tuple[Array, Array, Array]:
    """Value and first two derivatives (T, K) of values (T, K) at t (T,): a polynomial through the nearest samples.

    At every instant a polynomial of `degree` is fitted, by least squares, to the `window` samples around it (at the
    ends: the first or last window). On evenly spaced samples this is Savitzky and Golay's filter (1964); the samples
    here need not be even. InputError where times do not rise, or are fewer than the window, or the window has fewer
    samples than the polynomial coefficients.
    """
    if window <= degree:
        raise InputError(f"{window} is too few", field="window", expected=f"at least {degree + 1} samples")
    if t.size < window or np.any(np.diff(t) <= 0.0) or not np.all(np.isfinite(values)):
        raise InputError(
            "samples cannot be differentiated", field="t", expected=f"{window} rising times, finite values"
        )
    first = np.clip(np.arange(t.size) - window // 2, 0, t.size - window)
    index = first[:, None] + np.arange(window)
    span = (t[index[:, -1]] - t[index[:, 0]])[:, None]
    away = (t[index] - t[:, None]) / span
    powers = away[..., None] ** np.arange(degree + 1)
    coefficients = np.linalg.pinv(powers) @ values[index]
    derivatives = [factorial(k) * coefficients[:, k] / span**k for k in range(3)]
    return derivatives[0], derivatives[1], derivatives[2]


def measured_motion(
    arm: Arm, t: Array, q: Array, base: Array, *, q_rate: Array | None = None, window: int = 7
) -> MeasuredMotion:
    """The motion behind measured curvatures q (T, n) at t (T,) [s], the base turning as base (3, T): theta and
    derivatives.

    Derivatives come from quartics over `window` samples (local_polynomials). A measured q_rate (T, n) replaces the
    first derivative, and its own derivative replaces the second.
    """
    smooth, rate, acceleration = local_polynomials(t, q, window)
    if q_rate is not None:
        rate, acceleration, _ = local_polynomials(t, q_rate, window)
    rows = [
        np.concatenate([values @ arm.from_monomial.T, angle[:, None], np.zeros((t.size, 1))], axis=1)
        for values, angle in zip((smooth, rate, acceleration), base, strict=True)
    ]
    return MeasuredMotion(t, *rows)


def memory_along(arm: Arm, parameters: Array, motion: MeasuredMotion) -> Array:
    """Memory (T, S, N) of the acting effects along the motion, zero at the start (dynamics.advanced_memory)."""
    effects = active_effects(parameters)
    c_rate = motion.u_rate[:, : arm.order] @ arm.curvature_basis.T
    memory = np.zeros((motion.t.size, len(remembering(effects)), arm.node_count))
    for k, duration in enumerate(np.diff(motion.t)):
        middle = 0.5 * (c_rate[k] + c_rate[k + 1])
        memory[k + 1] = advanced_memory(arm, effects, parameters, memory[k], middle, duration)
    return memory
