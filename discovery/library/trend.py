"""A parameter over the days of a library: its trend, and how much it varies by day and by recording.

    y_r = a + b (t_day(r) - t_0) + u_day(r) + w_r + e_r
    u ~ N(0, by_day^2),    w ~ N(0, by_recording^2),    e ~ N(0, s_r^2)

y_r, s_r: the estimate of recording r with its standard deviation. The variances are those of the largest restricted
likelihood (REML), a and b the generalised least squares beside them; the interval of b is Student's, with as many
degrees of freedom as days beyond two. Sources: Patterson and Thompson 1971 (REML); Viechtbauer 2005 (known s_r).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.stats import t as student

from tentacle.signals import Array
from tentacle.solver_result import RESULTS

FEWEST_DAYS = 4  # days that show a trend: two more than its line needs
SMALLEST, LARGEST = 1e-4, 10.0  # of the values about their line: range of a spread between days or recordings
LEVELS = 7  # of each spread, from which its search begins


@dataclass(frozen=True)
class Trend:
    """start: the line's value at the first time, end: at the last; change = end - start with low, high (95 %) and
    p_value, None where there are too few days or the spreads' search did not converge. by_day, by_recording: spreads
    about the line. line (R,): its values.
    """

    start: float
    end: float
    change: tuple[float, float, float] | None
    p_value: float | None
    by_day: float
    by_recording: float
    line: Array

    @property
    def spread(self) -> float:
        """Standard deviation of a recording's true value about the line."""
        return float(np.hypot(self.by_day, self.by_recording))


def fit_trend(days: Array, values: Array, deviations: Array) -> Trend:
    """The trend of values (R,) with deviations (R,), inf where a recording does not show it; days (R,): times [d]."""
    known = np.isfinite(deviations) & np.isfinite(values)
    if not known.any():
        raise ValueError("no recording shows this parameter")
    t, y, s = days[known], values[known], deviations[known]
    _, day = np.unique(np.floor(t), return_inverse=True)
    count = int(day.max()) + 1
    t = (np.bincount(day, weights=t) / np.bincount(day))[day]  # what changes within a day is no trend over days
    design = np.ones((t.size, 1)) if count < FEWEST_DAYS else np.stack([np.ones(t.size), t - t.min()], axis=1)
    (by_day, by_recording), result = ((0.0, 0.0), RESULTS.CONVERGED) if t.size < 3 else _spreads(design, y, s, day)
    line, covariance, _ = _least_squares(design, y, s, day, (by_day, by_recording))
    if design.shape[1] == 1:
        return Trend(line[0], line[0], None, None, by_day, by_recording, np.full(days.size, line[0]))
    course = line[0] + line[1] * (days - t.min())
    span = float(t.max() - t.min())
    if not result.converged:
        return Trend(line[0], line[0] + line[1] * span, None, None, by_day, by_recording, course)
    change, deviation = line[1] * span, float(np.sqrt(covariance[1, 1])) * span
    reach = float(student.ppf(0.975, count - 2)) * deviation
    p_value = float(2.0 * student.sf(abs(change) / deviation, count - 2))
    return Trend(
        line[0], line[0] + change, (change, change - reach, change + reach), p_value, by_day, by_recording, course
    )


def _spreads(design: Array, y: Array, s: Array, day: NDArray[np.int64]) -> tuple[tuple[float, float], RESULTS]:
    """Spreads by day and by recording of the largest restricted likelihood, and how the search for them ended; of days
    with one recording each only their sum.
    """
    alone = np.bincount(day).max() == 1
    left = y - design @ np.linalg.lstsq(design, y, rcond=None)[0]
    unit = max(float(np.std(left)), float(np.median(s)))

    def spreads(logs: Array) -> tuple[float, float]:
        sizes = unit * np.exp(logs)
        return (0.0, float(sizes[0])) if alone else (float(sizes[0]), float(sizes[1]))

    def cost(logs: Array) -> float:
        return _least_squares(design, y, s, day, spreads(logs))[2]

    levels = np.linspace(np.log(SMALLEST), np.log(LARGEST), LEVELS)
    starts = np.stack(np.meshgrid(*[levels] * (1 if alone else 2)), axis=-1).reshape(-1, 1 if alone else 2)
    start = min(starts, key=cost)
    bounds = [(levels[0], levels[-1])] * start.size
    found = minimize(cost, start, bounds=bounds, method="Nelder-Mead", options={"xatol": 0.01})
    return spreads(found.x), RESULTS.CONVERGED if found.success else RESULTS.MAX_STEPS


def _least_squares(
    design: Array, y: Array, s: Array, day: NDArray[np.int64], spreads: tuple[float, float]
) -> tuple[Array, Array, float]:
    """Line (D,), its covariance (D, D), and minus the log restricted likelihood [nats] at these spreads.

    The covariance of a day's recordings is diagonal plus a constant: its inverse is that of Sherman and Morrison.
    """
    by_day, by_recording = spreads
    weight = 1.0 / (s**2 + by_recording**2)
    columns = np.concatenate([design, y[:, None]], axis=1)
    sums = np.stack([np.bincount(day, weights=weight * column) for column in columns.T], axis=1)
    total = np.bincount(day, weights=weight)
    shrink = by_day**2 / (1.0 + by_day**2 * total)
    gram = columns.T @ (weight[:, None] * columns) - sums.T @ (shrink[:, None] * sums)
    information, slope = gram[:-1, :-1], gram[:-1, -1]
    line = np.linalg.solve(information, slope)
    square = float(gram[-1, -1] - slope @ line)
    log_determinant = -np.log(weight).sum() + np.log1p(by_day**2 * total).sum()
    restricted = float(np.linalg.slogdet(information)[1])
    covariance: Array = np.asarray(np.linalg.inv(information), dtype=np.float64)
    return np.asarray(line, dtype=np.float64), covariance, 0.5 * float(square + log_determinant + restricted)
