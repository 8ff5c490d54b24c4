"""Runs are interpolated with an error of fourth order, and held before their start."""

from __future__ import annotations

import numpy as np
import pytest

from inference.interpolate import at_times


def test_a_cubic_is_exact():
    """A cubic Hermite piece holds any cubic: only rounding is left (times of its coefficients, of order 1)."""
    t = np.linspace(0.2, 1.2, 11)
    values, rates = (t**3 - 2.0 * t)[:, None, None], (3.0 * t**2 - 2.0)[:, None, None]
    times = np.linspace(0.2, 1.19, 37)
    found = at_times(t, values, rates, times[:, None])[:, 0, 0]
    assert found == pytest.approx(times**3 - 2.0 * times, abs=1e-12)


def test_halving_the_step_divides_the_error_by_sixteen():
    times = np.linspace(0.0, 0.99, 400)[:, None]
    errors = []
    for count in (11, 21):
        t = np.linspace(0.0, 1.0, count)
        found = at_times(t, np.sin(9.0 * t)[:, None, None], 9.0 * np.cos(9.0 * t)[:, None, None], times)
        errors.append(np.abs(found[:, 0, 0] - np.sin(9.0 * times[:, 0])).max())
    assert errors[0] / errors[1] == pytest.approx(16.0, rel=0.15)  # fourth order, up to the sixth order's share


def test_each_lane_may_have_its_own_times():
    t = np.linspace(0.0, 1.0, 21)
    values = np.stack([np.sin(t), np.cos(t)], axis=1)[:, :, None].repeat(3, axis=2)
    rates = np.stack([np.cos(t), -np.sin(t)], axis=1)[:, :, None].repeat(3, axis=2)
    times = np.linspace(0.0, 0.9, 50)[:, None] + np.array([0.0, 0.01, 0.05])
    together = at_times(t, values, rates, times)
    for lane in range(3):
        alone = at_times(t, values[:, :, :1], rates[:, :, :1], times[:, lane : lane + 1])
        assert np.array_equal(together[:, :, lane], alone[:, :, 0])


def test_before_the_first_instant_values_follow_the_tangent():
    t = np.linspace(1.0, 2.0, 11)
    found = at_times(t, t[:, None, None] ** 2, 2.0 * t[:, None, None], np.array([[0.7]]))
    assert found[0, 0, 0] == pytest.approx(1.0 - 0.3 * 2.0)
