"""Gaits: one definition, its derivatives, its band, and the servo's limits that every gait obeys."""

import numpy as np
import pytest

from affine_model.swim.gaits import gait_of, gait_tables
from affine_model.swim.limits import Box, GaitLimits, search_box
from affine_model.swim.trial import within_limits
from tentacle.errors import InputError
from tentacle.gait import Gait
from tentacle.waveform import Sine

LIMITS = GaitLimits()


def random_gaits(count, seed=0):
    return search_box(LIMITS).alpha(np.random.default_rng(seed).random((9, count)))


def test_batch_table_equals_the_gait():
    alpha = random_gaits(21)  # more than one block of the compiled loop, and a part of one
    table, peaks = gait_tables(alpha, 1500, 1 / 150, LIMITS.bandwidth, start=0.25)
    t = 0.25 + np.arange(1500) / 150
    for b in range(21):
        one = gait_of(alpha[:, b], LIMITS.bandwidth)(t)
        # Phasors are turned at most 512 times between renewals: rounding of 512 eps on accelerations of some 1e3
        # rad/s^2.
        assert np.max(np.abs(table[:, :, b] - one)) < 1e-9
        assert np.allclose(peaks[:, b], np.max(np.abs(one), axis=1), rtol=1e-12)


def test_derivatives_are_those_of_the_angle():
    wave = gait_of(random_gaits(1)[:, 0], LIMITS.bandwidth)
    t, h = np.linspace(0.0, 3.0, 200), 1e-4
    ahead, behind, here = wave(t + h), wave(t - h), wave(t)
    # Central differences: h^2/6 times the next two derivatives, at most (2 pi 5 Hz)^3 rad/s^3, leaves 1e-4 of the rate.
    for k in (0, 1):
        scale = np.max(np.abs(here[k + 1]))
        assert np.max(np.abs((ahead[k] - behind[k]) / (2 * h) - here[k + 1])) < 1e-4 * scale


def test_a_sine_is_a_gait():
    sine, gait = Sine(0.4, 1.2, 0.3), Gait((0.4, 0.0, 0.0, 2 * np.pi * 1.2, 1.0, 1.0, 0.3, 0.0, 0.0))
    t = np.linspace(0.0, 5.0, 101)
    assert np.allclose(gait(t), sine(t), atol=1e-12)


def test_square_and_saw_converge_to_their_shapes():
    # Far below the band, at a quarter of the period: an alternating series' error is under its first omitted term,
    # 1/11 for the square wave and 1/7 for the saw-tooth (whose even terms vanish there).
    omega = 2 * np.pi * 0.01
    t = np.array([0.25, 0.75]) * 100.0
    square = Gait((0.0, 1.0, 0.0, 1.0, omega, 1.0, 0.0, 0.0, 0.0))(t)[0]
    assert np.allclose(square, [np.pi / 4, -np.pi / 4], atol=1 / 11)
    saw = Gait((0.0, 0.0, 1.0, 1.0, 1.0, omega, 0.0, 0.0, 0.0))(t)[0]
    assert np.allclose(saw, [np.pi / 4, -np.pi / 4], atol=1 / 7)


def test_nothing_moves_above_the_band():
    # Fundamentals at whole fractions of the window, so that every harmonic is one line of the spectrum.
    alpha = np.array([0.2, 0.4, 0.3, 2 * np.pi * 0.5, 2 * np.pi * 0.75, 2 * np.pi * 1.25, 0.1, 0.7, 1.9])
    t = np.arange(4000) / 100.0
    spectrum = np.abs(np.fft.rfft(gait_of(alpha, 5.0)(t)[0]))
    frequency = np.fft.rfftfreq(4000, 0.01)
    assert np.max(spectrum[frequency >= 5.0]) < 1e-12 * np.max(spectrum)


def test_limits_hold_between_the_samples():
    scaled = within_limits(random_gaits(40, seed=3), LIMITS, 20.0, 0.005)
    _, peaks = gait_tables(scaled, 80000, 0.00025, LIMITS.bandwidth)
    # A peak between samples 5 ms apart rises by at most (2 pi 5 Hz x 2.5 ms)^2 / 2 = 0.3 %.
    assert np.all(peaks <= 1.004 * LIMITS.bounds.kinematic[:, None])
    # Nothing is scaled further than needed: every gait was too large, so each now touches one limit.
    assert np.all(np.max(peaks / LIMITS.bounds.kinematic[:, None], axis=0) > 0.999)


def test_gentle_gaits_stay_as_they_are():
    alpha = random_gaits(8, seed=4)
    alpha[:3] *= 0.02
    assert np.array_equal(within_limits(alpha, LIMITS, 10.0, 0.005), alpha)


def test_unit_cube_and_back():
    box = search_box(LIMITS)
    unit = np.random.default_rng(5).random((9, 30))
    assert np.allclose(box.unit(box.alpha(unit)), unit, atol=1e-12)


@pytest.mark.parametrize(
    ("limits", "field"),
    [
        ({"torque": 0.0}, "limits.torque"),
        ({"bandwidth": float("nan")}, "limits.bandwidth"),
        ({"lowest_frequency": 3.0}, "limits"),
        ({"bandwidth": 1.0}, "limits"),
    ],
)
def test_infeasible_limits_are_one_line(limits, field):
    with pytest.raises(InputError) as error:
        GaitLimits(**limits)
    assert error.value.field == field
    assert "\n" not in str(error.value)


def test_crossing_bounds_are_one_line():
    with pytest.raises(InputError, match=r"alpha_2.*cross"):
        Box((0.0,) * 9, (1.0, -1.0, *[1.0] * 7))
