"""On what a missing force depends: the place and the coordinate of a force that is known are found again."""

from __future__ import annotations

import numpy as np
import pytest

from affine_model.arm import Arm
from affine_model.dynamics import Instant
from discovery.laws.along import force_map, shown_instants
from discovery.laws.over import _levers, acting_place, over_coordinates, over_words, place_along, predicted
from inference.cells import cells_of
from inference.missing_force import SeenMotion, _between_frames
from tentacle.specimen import WATER, Cone, Specimen

ARM = Arm(Specimen(Cone(0.011, 0.004), 0.14, 1070.0), WATER, order=4)
N = ARM.order
T = np.arange(0.0, 20.0, 1.0 / 150.0)
EVERY = np.arange(T.size)


def swinging():
    """A motion of incommensurate frequencies, so that no coordinate is a function of another one."""
    random = np.random.default_rng(1)
    u, rate, acceleration = np.zeros((3, T.size, N + 2))
    for j in range(N + 1):
        for frequency in random.uniform(0.3, 2.5, 3):
            size, phase, turn = 0.4 / (1.0 + j), random.uniform(0.0, 6.28), 2.0 * np.pi * frequency
            u[:, j] += size * np.sin(turn * T + phase)
            rate[:, j] += size * turn * np.cos(turn * T + phase)
            acceleration[:, j] -= size * turn**2 * np.sin(turn * T + phase)
    none = np.zeros((T.size, N))
    return SeenMotion(T, u, rate, acceleration, none, none + 1e-6, 0.1, Instant(0.0), T >= 0.0)


def with_force(motion, s, force):
    """The motion with the generalised force of a normal force (T,) at s."""
    return SeenMotion(**{**vars(motion), "force": _levers(ARM, motion.u, s) * force[:, None]})


def test_levers_are_the_slopes_of_the_place_along_its_normal():
    motion = swinging()
    s, step = 0.7, 1e-6
    place = place_along(ARM, motion, s, EVERY)
    for j in range(N):
        ahead = motion.u.copy()
        ahead[:, j] += step
        moved = place_along(ARM, SeenMotion(**{**vars(motion), "u": ahead}), s, EVERY)
        slope = np.sum((moved.position - place.position) * place.normal, axis=1) / step
        # A forward difference: off by step times the second derivative, of order .1 m.
        assert _levers(ARM, motion.u, s)[:, j] == pytest.approx(slope, abs=1e-6)


def test_velocity_and_acceleration_are_the_place_s_own():
    place = place_along(ARM, swinging(), 0.6, EVERY)
    interval = T[1] - T[0]
    for value, slope in ((place.position, place.velocity), (place.velocity, place.acceleration)):
        middle = (value[2:] - value[:-2]) / (2.0 * interval)
        # Central differences at 150 a second of at most 3 Hz: (2 pi 3 / 150)^2 / 6 of the slope.
        assert np.abs(middle - slope[1:-1]).max() < 0.01 * np.abs(slope).max()


@pytest.mark.parametrize("s", [0.6, 1.0])
def test_a_force_of_the_velocity_at_a_place_is_found_as_that(s):
    motion = swinging()
    place = place_along(ARM, motion, s, EVERY)
    across = np.sum(place.velocity * place.normal, axis=1)
    found = over_coordinates("one", ARM, with_force(motion, s, -(np.maximum(across, 0.0) ** 2)))
    best = found[0]
    assert best.s == pytest.approx(s)
    assert best.explained == pytest.approx(1.0, abs=1e-9)
    assert best.coordinate == "normal velocity"
    assert best.predicted > 0.8  # 16 bins of a parabola: the last one holds half of its values' range
    assert "normal velocity" in over_words(found)


def test_a_curve_predicts_nothing_where_the_force_does_not_depend_on_it():
    random = np.random.default_rng(2)
    x, force = random.standard_normal((2, T.size))
    assert predicted(T, x, force) < 0.01  # 16 means of 190 values each: 1 / 190 of the variance, below zero on average


def test_a_force_of_one_frequency_is_found_as_periodic():
    motion = swinging()
    found = over_coordinates("one", ARM, with_force(motion, 0.8, np.sin(2.0 * np.pi * 3.1 * T + 0.4)))
    best = found[0]
    # The phase of a frequency that is off by 1 / (16 * 20 s) slips by a sixteenth of a period; 16 bins of a sine.
    assert best.frequency == pytest.approx(3.1, abs=1.0 / (16 * 20.0))
    assert best.predicted > 0.95
    assert "It is periodic at 3.1 Hz" in over_words(found)


def test_a_force_that_repeats_with_the_base_is_not_called_periodic():
    motion = swinging()
    turn = 2.0 * np.pi * 0.8
    for rows, value in (
        (motion.u, np.sin(turn * T)),
        (motion.rate, turn * np.cos(turn * T)),
        (motion.acceleration, -(turn**2) * np.sin(turn * T)),
    ):
        rows[:] = 0.0
        rows[:, N] = 0.4 * value
    found = over_coordinates("one", ARM, with_force(motion, 0.8, np.cos(turn * T)))
    assert all(one.frequency is None for one in found)


def test_forces_along_the_arm_are_no_single_one():
    """Two independent forces at two places: no single place explains both."""
    motion = swinging()
    random = np.random.default_rng(3)
    both = np.zeros((T.size, N))
    for s in (0.3, 1.0):
        levers = _levers(ARM, motion.u, s)
        both += levers / np.linalg.norm(levers, axis=1)[:, None] * random.standard_normal(T.size)[:, None]
    _, explained, _ = acting_place(ARM, SeenMotion(**{**vars(motion), "force": both}), EVERY)
    assert explained < 0.97


def test_a_force_where_no_frame_was_used_moves_no_place_and_is_not_shown():
    """There the smoother returns to the model; the force that this takes is no measurement."""
    motion = swinging()
    true = with_force(motion, 0.6, np.sin(9.0 * T))
    wild = with_force(motion, 0.9, 1e3 * np.cos(T))
    hidden = (T > 8.0) & (T < 12.0)
    force = np.where(hidden[:, None], wild.force, true.force)
    partly = SeenMotion(**{**vars(true), "force": force, "seen": ~hidden})
    s, explained, _ = acting_place(ARM, partly, shown_instants(partly))
    assert s == pytest.approx(0.6)
    assert explained == pytest.approx(1.0, abs=1e-6)
    shown, whole = force_map("a", ARM, partly), force_map("a", ARM, true)
    unseen = (shown.t > 8.0) & (shown.t < 12.0)
    assert np.isnan(shown.force[unseen]).all()
    assert np.isnan(shown.tip_force[unseen]).all()
    # Outside it is the map of the true force: only its power, the scale of the prior, changes by the share of instants.
    np.testing.assert_allclose(shown.force[~unseen], whole.force[~unseen], rtol=1e-3, atol=1e-3 * whole.force.max())


def test_a_motion_is_seen_between_frames_alone():
    """A gap of 2 s hides itself and a force's time of .5 s on each side, as do both ends of the recording: to a cell.
    Three cells in ten that are lost here and there hide nothing.
    """
    frames = np.arange(600) / 60.0
    lost = np.isin(np.floor(frames / 0.1) % 10, (2, 5, 8))
    for kept in (frames >= 0.0, ~lost):
        cells = cells_of(frames, ((frames < 4.0) | (frames > 6.0)) & kept, 0.5)
        times = np.arange(0.0, 10.0, 1.0 / 150.0)
        seen = _between_frames(cells, times)
        far = 0.5 + 2.0 * cells.interval
        near = 0.5 - cells.interval
        for low, high in ((0.0, 4.0), (6.0, 10.0)):
            assert seen[(times > low + far) & (times < high - far)].all()
            assert not seen[(times > low) & (times < low + near)].any()
            assert not seen[(times > high - near) & (times < high)].any()
        assert not seen[(times > 4.0) & (times < 6.0)].any()


@pytest.mark.parametrize("count", [30, 93, 160])
def test_a_force_that_is_seen_for_a_second_or_less_has_a_curve_too(count):
    """Stretches of a second would leave a curve fewer instants than bins; warnings are errors here."""
    t = T[:count]
    force = np.sin(3.0 * t)
    # A curve over the force itself, on even fifths: the rest is the width of a bin and the ends that it did not see.
    assert predicted(t, force, force) > 0.5


def test_a_recording_too_short_to_be_far_from_its_ends_counts_whole():
    cells = cells_of(np.arange(60) / 60.0, np.ones(60, dtype=bool), 0.5)
    assert _between_frames(cells, np.linspace(0.0, 1.0, 40)).all()
