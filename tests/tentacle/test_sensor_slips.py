"""Slips of sensors on the arm are found by what the pictures show; sound sensors pass, whatever their zeros."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from tentacle.errors import InputError
from tentacle.recording import Declaration, Recording
from tentacle.seen_arm import seen_arm
from tentacle.signals import AccelerationSignal, Accelerometer, Array, Markers, Midline, StrainGauge, StrainSignal
from tentacle.slip import Slip
from tentacle.slips import find_slips, refuse_slips
from tentacle.specimen import WATER, Gravity
from tests.made_recordings import SPECIMEN, Run, as_markers, record_declared

AXES = (Accelerometer(1.0, 0.0, "normal"), Accelerometer(1.0, 0.0, "tangent"))
ZEROS = np.array([0.6, -0.8])  # m/s^2, of cheap sensors
BLUR = 5e-4  # m
GAUGE = StrainGauge(0.2, 0.012)
G = 9.80665


def sensed(angle: float) -> Recording:
    """An arm in water whose gravity has that angle, seen at 60 Hz with noise, with both axes at the tip and a gauge."""
    clean = record_declared(Declaration(SPECIMEN, WATER, Gravity(angle)), {}, Run(seconds=6.0, noise=1e-9))
    line, motor = clean.midline, clean.motor
    assert line is not None
    assert motor is not None
    interval = line.t[1] - line.t[0]
    force = (line.xy[2:, -1] - 2.0 * line.xy[1:-1, -1] + line.xy[:-2, -1]) / interval**2
    force = force - G * np.array([np.sin(angle), np.cos(angle)])
    chords = np.diff(line.xy, axis=1)
    phi = np.unwrap(np.arctan2(-chords[..., 0], chords[..., 1]), axis=1)
    tip = phi[1:-1, -1]
    normal, tangent = np.stack([np.cos(tip), np.sin(tip)], 1), np.stack([-np.sin(tip), np.cos(tip)], 1)
    read = np.stack([np.sum(force * normal, axis=1), np.sum(force * tangent, axis=1)], axis=1)
    bend = (phi[:, 4] - phi[:, 3]) / (line.s[1] - line.s[0])  # chords that meet at the gauge
    strain = GAUGE.d / SPECIMEN.length * bend[:, None] + 0.03
    seen = Midline(line.t, line.s, line.xy + BLUR * np.random.default_rng(0).standard_normal(line.xy.shape), line.sigma)
    return replace(
        clean,
        midline=seen,
        acceleration=AccelerationSignal(line.t[1:-1], ("across", "along"), AXES, read + ZEROS),
        strain=StrainSignal(line.t, ("root",), (GAUGE,), strain),
    )


@pytest.fixture(scope="module")
def hanging() -> Recording:
    return sensed(0.0)


@pytest.fixture(scope="module")
def level() -> Recording:
    return sensed(np.pi / 2)


def felt(recording: Recording, change: Callable[[Array], Array]) -> Recording:
    """The recording with other accelerations."""
    read = recording.acceleration
    assert read is not None
    return replace(recording, acceleration=replace(read, values=change(read.values)))


def tare(rest: slice, values: Array) -> Array:
    """Accelerations less their mean over some of them."""
    return values - values[rest].mean(axis=0)


def stretched(recording: Recording, factor: float) -> Recording:
    """The recording with other strains."""
    assert recording.strain is not None
    return replace(recording, strain=replace(recording.strain, values=factor * recording.strain.values))


def placed(recording: Recording, d: float) -> Recording:
    """The recording with its accelerometers at another distance from the midline."""
    assert recording.acceleration is not None
    moved = tuple(replace(one, d=d) for one in recording.acceleration.accelerometers)
    return replace(recording, acceleration=replace(recording.acceleration, accelerometers=moved))


def every(recording: Recording, step: int) -> Recording:
    """The recording with fewer accelerations."""
    read = recording.acceleration
    assert read is not None
    return replace(recording, acceleration=replace(read, t=read.t[::step], values=read.values[::step]))


def only(recording: Recording) -> Slip:
    """The one slip that is found."""
    (slip,) = find_slips(recording)
    return slip


@pytest.mark.parametrize("angle", [0.0, np.pi / 2, -np.pi / 2, 0.8])
def test_sound_sensors_have_no_slip(angle: float) -> None:
    sound = sensed(angle)
    assert find_slips(sound) == []
    for places in ((1.0,), (0.4, 0.7, 1.0)):
        assert find_slips(as_markers(sound, places)) == []
    assert find_slips(replace(sound, midline=None, strain=None)) == []  # a film that is not tracked


def test_what_lies_in_g_is_refused(hanging: Recording, level: Recording) -> None:
    for recording in (hanging, level, as_markers(hanging, (0.4, 0.7, 1.0))):
        with pytest.raises(InputError, match=r"multiply by 9\.80665") as refused:
            refuse_slips(felt(recording, lambda values: values / G))
        assert refused.value.file is not None
        assert refused.value.file.name == "acceleration.csv"


def test_a_wrong_sign_is_refused_where_gravity_tells_and_advised_where_motion_does(
    hanging: Recording, level: Recording
) -> None:
    along = only(felt(hanging, lambda values: values * [1.0, -1.0]))
    assert along.certain
    assert (along.file, along.field) == ("acceleration.csv", "along_m_s2")
    assert "gravity give -9.8" in along.seen
    across = only(felt(hanging, lambda values: values * [-1.0, 1.0]))
    assert not across.certain  # gravity lies across it: the pictures' motion alone tells
    assert "pictures vary -" in across.seen
    assert only(felt(level, lambda values: values * [-1.0, 1.0])).certain


def test_in_a_film_that_is_not_tracked_an_arm_that_hangs_tells_the_sign(hanging: Recording) -> None:
    film = replace(felt(hanging, lambda values: -values), midline=None, strain=None)
    slip = only(film)
    assert slip.certain
    assert slip.field == "along_m_s2"
    aside = replace(film, declaration=replace(film.declaration, gravity=Gravity(0.8)))
    assert find_slips(aside) == []  # where it sags is not known


def test_axes_in_the_wrong_order_are_refused_by_both(hanging: Recording, level: Recording) -> None:
    for recording in (hanging, level):
        slip = only(felt(recording, lambda values: values[:, ::-1]))
        assert slip.certain
        assert slip.field == "acceleration.across.axis"
        assert "across and along exchanged" in slip.remedy


def test_a_sensor_that_was_set_to_zero_is_told_and_not_refused(hanging: Recording, level: Recording) -> None:
    for recording in (hanging, level):
        for rest in (slice(0, 1), slice(0, 20), slice(-20, None)):
            slips = find_slips(felt(recording, partial(tare, rest)))
            assert slips
            assert not any(slip.certain for slip in slips)
            assert all("gravity taken out" in slip.remedy for slip in slips)


def test_blank_slow_and_far_ones_are_refused(hanging: Recording) -> None:
    silent = find_slips(felt(hanging, lambda values: np.where([True, False], np.nan, values)))
    assert [(slip.field, slip.seen) for slip in silent] == [("across_m_s2", "blank in all of 359 rows")]
    slow = find_slips(every(hanging, 3))
    assert [slip.seen for slip in slow] == ["a reading every 0.05 s (20 Hz)"] * 2
    far = find_slips(placed(hanging, 0.5))
    assert [slip.field for slip in far] == ["acceleration.across.d", "acceleration.along.d"]
    assert all(slip.certain for slip in (*silent, *slow, *far))
    assert find_slips(placed(hanging, 0.03)) == []  # on a bracket


def test_a_gauge_s_sign_hides_no_accelerometer_s(hanging: Recording) -> None:
    both = stretched(felt(hanging, lambda values: -values), -1.0)
    assert {slip.file for slip in find_slips(both)} == {"strain.csv", "acceleration.csv"}


def test_readings_of_another_hour_are_refused(hanging: Recording) -> None:
    read = hanging.acceleration
    assert read is not None
    slips = find_slips(replace(hanging, acceleration=replace(read, t=read.t + 3600.0)))
    assert {slip.seen for slip in slips} == {"no reading while the arm is seen"}


@pytest.mark.parametrize(("factor", "certain"), [(1e6, True), (1e3, True), (100.0, True), (10.0, False), (-1.0, False)])
def test_a_strain_in_other_units_or_of_the_other_sign_is_told(hanging: Recording, factor: float, certain: bool) -> None:
    slip = only(stretched(hanging, factor))
    assert (slip.file, slip.field, slip.certain) == ("strain.csv", "root_strain", certain)
    assert ("sign" in slip.remedy) == (factor < 0.0)


def test_a_gauge_s_place_in_millimetres_is_refused_by_its_strain_and_a_sensor_of_curvature_is_none(
    hanging: Recording,
) -> None:
    strain = hanging.strain
    assert strain is not None
    millimetres = replace(hanging, strain=replace(strain, gauges=(replace(GAUGE, d=1e3 * GAUGE.d),)))
    slips = find_slips(millimetres)
    assert [(slip.field, slip.certain) for slip in slips] == [("strain.root.d", False), ("root_strain", True)]
    curvature = replace(strain, gauges=(replace(GAUGE, d=1.0),), values=strain.values / GAUGE.d)
    assert find_slips(replace(hanging, strain=curvature)) == []


def test_an_arm_that_is_seen_as_an_arc_has_the_arc_s_places_directions_and_bend() -> None:
    # Of constant curvature, chords point as the arc does at their middles; places between lie at most 1/8 of a sagitta
    # off: s^2 c / 8 of s = 1/8 of the arm.
    bend, t = 0.8, np.linspace(0.0, 1.0, 30)
    s = np.linspace(0.0, 1.0, 41)
    arc = np.stack([(np.cos(bend * s) - 1.0) / bend, np.sin(bend * s) / bend], axis=1) * SPECIMEN.length
    xy = np.repeat(arc[None], 30, axis=0)
    made = Recording("arc", Declaration(SPECIMEN), midline=Midline(t, s, xy, np.full(xy.shape[:2], 1e-4)))
    beside = xy[:, [20, 40]] + 0.01 * np.stack([np.cos(bend * s), np.sin(bend * s)], 1)[[20, 40]]
    marked = replace(made, midline=None, markers=Markers(t, ("a", "b"), s[[20, 40]], np.full(2, 0.01), beside))
    for recording, place_off, turn_off in ((made, 3e-4, 1e-9), (marked, 0.15, 0.05)):
        arm = seen_arm(recording)
        assert arm is not None
        np.testing.assert_allclose(arm.direction(0.7), bend * 0.7, atol=turn_off)
        np.testing.assert_allclose(arm.bend(0.3), bend, rtol=0.15)
        np.testing.assert_allclose(arm.place(0.625), [arc[25]] * 30, atol=max(place_off, 2e-3) * SPECIMEN.length)
