"""The base's motion from samples of the servo angle: a quintic spline with as much smoothing as the samples ask for.

The arm is driven by theta's acceleration, and a second difference of samples is mostly noise. The penalised spline

    minimise  sum_i (y_i - theta(t_i))^2 + weight int theta'''(t)^2 dt

has a knot at every sample, so weight = 0 interpolates. The weight maximises the restricted likelihood (Wahba 1985;
Reinsch form with a B-spline basis, Eilers and Marx 1996). Where noise makes the samples no likelier, they are clean
and are interpolated. All matrices are banded: a run of 40 000 samples takes about a second.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import BSpline, make_interp_spline
from scipy.linalg import LinAlgError, cholesky_banded, cho_solve_banded
from scipy.optimize import minimize_scalar

from tentacle.errors import InputError
from tentacle.signals import Array, MotorSignal

DEGREE = 5
PENALISED_DERIVATIVE = 3
MARGIN = 0.05  # s beyond the first and last sample, where the motion goes on at its last rate
EVIDENCE_FOR_NOISE = 2.0  # nats of restricted likelihood
WEIGHTS = (1e-8, 1e12)  # searched, in units of the mean sampling interval ** (2 * PENALISED_DERIVATIVE - 1)


@dataclass(frozen=True)
class BaseMotion:
    """A waveform through samples: called with t (...) [s] it gives theta, rate and acceleration (3, ...).

    start, stop [s]: where samples are; noise [rad]: the standard deviation of the samples about it, 0 where clean.
    """

    spline: BSpline
    start: float
    stop: float
    noise: float

    def __call__(self, t: ArrayLike) -> Array:
        """Theta [rad], rate and acceleration at t. InputError farther than MARGIN outside the samples."""
        t = np.asarray(t, dtype=float)
        if t.size and (t.min() < self.start - MARGIN or t.max() > self.stop + MARGIN):
            raise InputError(
                f"the servo's angle is asked for from {t.min():.4g} to {t.max():.4g} s",
                field="motor",
                expected=f"times from {self.start:.4g} to {self.stop:.4g} s, where it was measured",
            )
        inside = np.clip(t, self.start, self.stop)
        theta, rate, acceleration = (self.spline(inside, derivative) for derivative in range(3))
        return np.stack([theta + rate * (t - inside), rate, np.where(t == inside, acceleration, 0.0)])


def fit_base_motion(motor: MotorSignal) -> BaseMotion:
    """The motion behind the measured angle. InputError with fewer samples than a quintic needs, 6."""
    t, angle = motor.t, motor.angle
    if len(t) <= DEGREE:
        raise InputError(f"{len(t)} samples", field="motor", expected=f"at least {DEGREE + 1}")
    interpolation = BaseMotion(make_interp_spline(t, angle, k=DEGREE), float(t[0]), float(t[-1]), 0.0)
    trend = np.polynomial.Polynomial.fit(t, angle, PENALISED_DERIVATIVE - 1)
    if np.abs(angle - trend(t)).max() <= 1e-12 * (1.0 + np.abs(angle).max()):
        return interpolation  # a parabola, or rest: nothing to smooth, and no noise to measure
    smoother = _Smoother.of(t, angle - trend(t))
    low, high = np.log(WEIGHTS)
    grid = np.linspace(low, high, 24)
    scores = [smoother.score(value) for value in grid]
    best = int(np.argmin(scores))
    found = minimize_scalar(
        smoother.score, bounds=(grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)]), method="bounded"
    )
    if scores[0] - min(found.fun, scores[best]) < EVIDENCE_FOR_NOISE:
        return interpolation
    coefficients, noise = smoother.solve(found.x)
    knots = interpolation.spline.t
    smooth_trend = make_interp_spline(t, trend(t), k=DEGREE).c
    return BaseMotion(BSpline(knots, coefficients + smooth_trend, DEGREE), interpolation.start, interpolation.stop, noise)


@dataclass(frozen=True)
class _Smoother:
    """The banded normal equations of the penalised spline, time in mean sampling intervals."""

    gram: Array  # (6, N) upper banded B'B
    penalty: Array  # (6, N) upper banded P
    right: Array  # (N,) B'y
    square: float  # y'y
    count: int

    @staticmethod
    def of(t: Array, y: Array) -> _Smoother:
        scaled = (t - t[0]) * (len(t) - 1) / (t[-1] - t[0])
        knots = make_interp_spline(scaled, y, k=DEGREE).t
        design = BSpline.design_matrix(scaled, knots, DEGREE)
        return _Smoother(
            gram=_upper_bands(design.T @ design),
            penalty=_upper_bands(_penalty(knots)),
            right=design.T @ y,
            square=float(y @ y),
            count=len(t),
        )

    def _factor(self, log_weight: float) -> tuple[Array, Array, float]:
        """Cholesky factor, coefficients and penalised sum of squares."""
        factor = cholesky_banded(self.gram + np.exp(log_weight) * self.penalty)
        coefficients = cho_solve_banded((factor, False), self.right)
        return factor, coefficients, max(self.square - float(self.right @ coefficients), 1e-300)

    def score(self, log_weight: float) -> float:
        """Minus the restricted log likelihood, the noise's variance profiled out; infinite where it cannot be had."""
        try:
            factor, _, squares = self._factor(log_weight)
        except LinAlgError:
            return np.inf
        free = self.count - PENALISED_DERIVATIVE
        determinant = 2.0 * np.log(factor[-1]).sum()
        return 0.5 * (free * np.log(squares / free) + determinant - free * log_weight)

    def solve(self, log_weight: float) -> tuple[Array, float]:
        """Coefficients (N,), and the noise's standard deviation."""
        _, coefficients, squares = self._factor(log_weight)
        return coefficients, float(np.sqrt(squares / (self.count - PENALISED_DERIVATIVE)))


def _penalty(knots: Array):
    """P_ij = int B_i''' B_j''' dt; the integrand is a quartic between knots, so three Gauss points are exact."""
    count = len(knots) - DEGREE - 1
    edges = np.unique(knots)
    nodes, weights = np.polynomial.legendre.leggauss(3)
    half = 0.5 * np.diff(edges)
    points = (edges[:-1, None] + half[:, None] * (1.0 + nodes)).ravel()
    lower_degree = DEGREE - PENALISED_DERIVATIVE
    inner = knots[PENALISED_DERIVATIVE:-PENALISED_DERIVATIVE]
    values = BSpline.design_matrix(points, inner, lower_degree) @ _derivative_matrix(knots, count)
    root = values.multiply(np.sqrt((half[:, None] * weights).ravel())[:, None]).tocsr()
    return root.T @ root


def _derivative_matrix(knots: Array, count: int):
    """Coefficients of the third derivative in the B-splines of degree 2, from those of degree 5 (de Boor, ch. X)."""
    from scipy.sparse import diags_array

    matrix = diags_array(np.ones(count))
    for step in range(PENALISED_DERIVATIVE):
        degree = DEGREE - step
        inner = knots[step : len(knots) - step]
        span = inner[degree + 1 : -1] - inner[1 : -degree - 1]
        rows = len(span)
        difference = diags_array([-degree / span, degree / span], offsets=[0, 1], shape=(rows, rows + 1))
        matrix = difference @ matrix
    return matrix.tocsr()


def _upper_bands(matrix) -> Array:
    """A symmetric sparse matrix in LAPACK's upper banded form (6, N)."""
    size = matrix.shape[0]
    bands = np.zeros((DEGREE + 1, size))
    for offset in range(DEGREE + 1):
        bands[DEGREE - offset, offset:] = matrix.diagonal(offset)
    return bands
