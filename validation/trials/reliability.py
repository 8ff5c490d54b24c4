"""Stated confidence against the hit rate: the reliability curve, and the monotone map that corrects it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import isotonic_regression, minimize_scalar
from scipy.special import log_expit, logit

from discovery.calibration import Calibration
from tentacle.signals import Array
from validation.trials.outcome import Outcome
from validation.trials.rounds import ROUND
from validation.trials.scores import Share

CONFIDENCE_BINS = (0.0, 0.5, 0.7, 0.8, 0.9, 0.95, 1.0)
LOG_TEMPERATURES = (-2.0, 4.0)  # a temperature from .14 to 55
AT_END = 1e-2  # of the logarithm: nearer to an end the likelihood has no maximum between them
LEAST = 1e-6  # a posterior mass nearer to 0 or 1 has no meaning beyond rounding
IMAGINED_TRIALS = 4.0  # imagined trials that were right as often as stated: the prior of a verdict's map


@dataclass(frozen=True)
class Bin:
    """Trials whose stated confidence lies within low .. high: its mean, and the share that was right."""

    low: float
    high: float
    stated: float
    right: Share

    @property
    def gap(self) -> float:
        """Stated confidence minus the share that was right."""
        return self.stated - self.right.value

    @property
    def gap_beyond_chance(self) -> float:
        """Distance of the stated confidence from the share's 95 % interval; 0 within it."""
        low, high = self.right.interval
        return max(low - self.stated, self.stated - high, 0.0)


def _bins_of(stated: Array) -> NDArray[np.intp]:
    """Which of BINS each stated confidence lies in."""
    return np.clip(np.searchsorted(CONFIDENCE_BINS, stated, side="right") - 1, 0, len(CONFIDENCE_BINS) - 2)


def reliability(outcomes: Sequence[Outcome]) -> tuple[Bin, ...]:
    """The bins of BINS that hold a trial."""
    stated = np.array([o.confidence for o in outcomes])
    right = np.array([o.hit for o in outcomes], dtype=bool)
    place = _bins_of(stated)
    return tuple(
        Bin(
            CONFIDENCE_BINS[k],
            CONFIDENCE_BINS[k + 1],
            float(stated[place == k].mean()),
            Share(int(right[place == k].sum()), int((place == k).sum())),
        )
        for k in range(len(CONFIDENCE_BINS) - 1)
        if (place == k).any()
    )


def calibration_gap(bins: Sequence[Bin]) -> float:
    """Largest |stated - right| over the bins; NaN without any."""
    return max((abs(b.gap) for b in bins), default=float("nan"))


def gap_by_chance(outcomes: Sequence[Outcome], draws: int = 400) -> float:
    """The calibration gap (median) by chance alone, in as many trials, if every stated confidence were true. NaN
    without any.
    """
    if not outcomes:
        return float("nan")
    stated = np.array([o.confidence for o in outcomes])
    place = _bins_of(stated)
    counts = np.bincount(place, minlength=len(CONFIDENCE_BINS) - 1)
    filled = counts > 0
    means = np.bincount(place, stated, minlength=counts.size)[filled] / counts[filled]
    right = np.random.default_rng(0).uniform(size=(draws, stated.size)) < stated
    hits = np.array([np.bincount(place, row, minlength=counts.size)[filled] / counts[filled] for row in right])
    return float(np.median(np.abs(hits - means).max(axis=1)))


def temperature_cost(outcomes: Sequence[Outcome], temperature: float) -> float:
    """Minus the log likelihood [nats] of which trials were right, if discovery.calibration.tempered gave their
    probability.
    """
    odds = logit(np.clip([o.uncalibrated for o in outcomes], LEAST, 1.0 - LEAST)) / temperature
    return -float(np.sum(log_expit(np.where([o.hit for o in outcomes], odds, -odds))))


def fit_temperature(outcomes: Sequence[Outcome]) -> float | None:
    """The likeliest temperature of the confidence; None if the trials do not determine one within LOG_TEMPERATURES."""
    low, high = LOG_TEMPERATURES
    found: Any = minimize_scalar(lambda log: temperature_cost(outcomes, float(np.exp(log))), bounds=LOG_TEMPERATURES)
    inside = found.success and low + AT_END < found.x < high - AT_END
    return float(np.exp(found.x)) if inside else None


def fit_calibration(outcomes: Sequence[Outcome], made: str = "") -> Calibration:
    """A map for each verdict, from the uncalibrated confidence to the hit rate; made: one line on the trials.

    Isotonic regression on the trials together with the imagined ones, spread over the stated range: few trials change
    the map little, many determine it. A verdict that no trial gave keeps its stated confidence.
    """
    tables: dict[str, tuple[tuple[float, ...], tuple[float, ...], int]] = {}
    for verdict in sorted({o.verdict for o in outcomes}):
        chosen = [o for o in outcomes if o.verdict == verdict]
        stated = np.array([o.uncalibrated for o in chosen])
        ends = np.unique(np.concatenate([[0.0, 1.0], np.round(stated, 3)]))
        raw = np.concatenate([stated, ends])
        right = np.concatenate([[float(o.hit) for o in chosen], ends])
        weights = np.concatenate([np.ones(stated.size), np.full(ends.size, IMAGINED_TRIALS / ends.size)])
        order = np.argsort(raw, kind="stable")
        knots, place = np.unique(np.round(raw[order], 3), return_inverse=True)
        # Ties pooled first, so that the map is a function of the stated value.
        total: Array = np.bincount(place, weights[order]).astype(float)
        means = np.bincount(place, weights[order] * right[order]) / total
        rising = isotonic_regression(means, weights=total).x
        tables[verdict] = (tuple(knots.tolist()), tuple(np.round(rising, 4).tolist()), len(chosen))
    return Calibration(tables, made)


def cross_calibrated(outcomes: Sequence[Outcome]) -> list[Outcome]:
    """Every trial with the confidence from a map fitted to the other half of the trials: a test of the map on
    recordings that it has not seen.
    """
    rounds = len(ROUND)  # alternating, so that both halves have every kind
    maps = [fit_calibration([o for o in outcomes if o.index // rounds % 2 == half]) for half in (0, 1)]
    return [replace(o, confidence=maps[1 - o.index // rounds % 2](o.verdict, o.uncalibrated)) for o in outcomes]
