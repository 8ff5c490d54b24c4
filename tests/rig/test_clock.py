"""The clock's regression: skew, outliers, and an honest spread."""

from __future__ import annotations

import numpy as np
import pytest

from rig.clock import ClockEstimator


def trips(seconds: float, skew: float, seed: int, jitter: float = 2e-3) -> ClockEstimator:
    """Round trips at 20 Hz: 0.5 ms at best each way, exponential delays on top, a third of them very late."""
    source = np.random.default_rng(seed)
    estimator = ClockEstimator()
    for t in np.arange(0.0, seconds, 0.05):
        there, back = 5e-4 + source.exponential(jitter, 2) * (1 + 20 * (source.random(2) < 0.3))
        estimator.add(100.0 + t, 100.0 + t + there + back, 7.0 + (t + there) / (1 + skew))
    return estimator


@pytest.mark.parametrize("skew", [-8e-5, 0.0, 5e-5])
@pytest.mark.parametrize("seconds", [2.0, 60.0])
def test_board_time_is_known_to_a_fraction_of_the_jitter(skew: float, seconds: float) -> None:
    fit = trips(seconds, skew, seed=2).fit()
    t = np.linspace(0, seconds, 20)
    error = np.array([fit.to_board(100.0 + x) - (7.0 + x / (1 + skew)) for x in t])
    # The quickest quarter of trips has about 1 ms of delay left, unequal there and back: half of it, averaged, is the
    # error.
    assert np.abs(error).max() < 1e-3
    assert np.abs(error).max() < 5 * fit.sigma


def test_a_minute_gives_the_skew() -> None:
    assert trips(60.0, 5e-5, seed=3, jitter=5e-4).fit().skew == pytest.approx(5e-5, abs=1e-5)


def test_no_round_trip_is_no_clock() -> None:
    with pytest.raises(ValueError, match="no round trip"):
        ClockEstimator().fit()
