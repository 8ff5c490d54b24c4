"""A parameter over the days of a library: its change and its spread, with intervals that hold as often as they say."""

from __future__ import annotations

import numpy as np
import pytest

from discovery.library.trend import fit_trend

DAYS, EACH = 30, 4


def made(seed, *, by_day=0.01, by_recording=0.005, change=-0.04, deviation=0.004):
    random = np.random.default_rng(seed)
    days = np.repeat(np.arange(float(DAYS)), EACH) + np.tile(np.linspace(0.0, 0.4, EACH), DAYS)
    line = 1.0 + change * days / days.max()
    day = by_day * np.repeat(random.standard_normal(DAYS), EACH)
    own = np.hypot(by_recording, deviation) * random.standard_normal(days.size)
    return days, line + day + own, np.full(days.size, deviation)


def test_a_change_of_four_per_cent_is_found_and_its_interval_holds():
    found = [fit_trend(*made(seed)) for seed in range(100)]
    holds = np.mean([trend.change[1] <= -0.04 <= trend.change[2] for trend in found])
    assert holds == pytest.approx(0.95, abs=3.0 * np.sqrt(0.95 * 0.05 / 100))
    assert np.mean([trend.change[0] for trend in found]) == pytest.approx(-0.04, abs=0.002)  # .0065 / sqrt(100) * 3
    assert np.median([trend.by_day for trend in found]) == pytest.approx(0.01, rel=0.1)
    assert np.median([trend.by_recording for trend in found]) == pytest.approx(0.005, rel=0.15)


def test_no_change_is_claimed_in_one_of_twenty_libraries():
    found = [fit_trend(*made(seed, change=0.0)).p_value for seed in range(100)]
    assert np.mean(np.array(found) < 0.05) == pytest.approx(0.05, abs=3.0 * np.sqrt(0.95 * 0.05 / 100))


def test_days_that_differ_are_not_taken_for_many_recordings():
    """Of 30 days that differ by 1 % a line's end is known to some .65 %, however many recordings a day has."""
    low, high = fit_trend(*made(0, deviation=1e-4, by_recording=1e-4)).change[1:]
    assert high - low > 2.0 * 1.96 * 0.004


def test_a_recording_that_does_not_show_the_parameter_counts_for_nothing():
    days, values, deviations = made(3)
    values[7], deviations[7] = 100.0, np.inf
    kept = np.arange(days.size) != 7
    whole, part = fit_trend(days, values, deviations), fit_trend(days[kept], values[kept], deviations[kept])
    assert whole.change == pytest.approx(part.change, rel=1e-9)
    assert whole.line.size == days.size


def test_too_few_days_have_a_mean_and_no_change():
    days, values, deviations = made(1)
    few = fit_trend(days[: 3 * EACH], values[: 3 * EACH], deviations[: 3 * EACH])
    assert few.change is None
    assert few.p_value is None
    assert few.start == few.end
    with pytest.raises(ValueError, match="no recording"):
        fit_trend(days, values, np.full(days.size, np.inf))
