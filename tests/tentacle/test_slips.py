"""Slips of sign, unit and order are found; recordings without one pass."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from tentacle.errors import InputError
from tentacle.recording import Camera, Recording
from tentacle.signals import BaseTravel, MotorSignal, Video
from tentacle.slips import find_slips, refuse_slips
from tests.made_recordings import as_markers
from tests.tentacle.io.test_recording_rrd import small_video


def with_motor(recording: Recording, factor: float) -> Recording:
    motor = recording.motor
    assert motor is not None
    return replace(recording, motor=replace(motor, angle=factor * motor.angle, command=factor * motor.command))


def with_points(recording: Recording, change: Callable[[np.ndarray], np.ndarray]) -> Recording:
    midline = recording.midline
    assert midline is not None
    return replace(recording, midline=replace(midline, xy=change(midline.xy)))


def in_milliseconds(recording: Recording) -> Recording:
    midline = recording.midline
    assert midline is not None
    return replace(recording, midline=replace(midline, t=1e3 * midline.t))


def far_camera(recording: Recording) -> Recording:
    camera = Camera(60.0, 0.3, (320.0, 80.0), (0.0, 1.0))
    return replace(recording, declaration=replace(recording.declaration, camera=camera))


@pytest.fixture(scope="module")
def sound(recorded) -> Recording:
    return recorded(seconds=4.0)


def test_a_sound_recording_has_no_slip(sound) -> None:
    assert find_slips(sound) == []
    assert find_slips(as_markers(sound)) == []


@pytest.mark.parametrize(
    ("slip", "field", "remedy"),
    [
        (lambda r: with_motor(r, 180.0 / np.pi), "angle_rad", "degrees"),
        (in_milliseconds, "t_s", "milliseconds"),
        (lambda r: with_points(r, lambda xy: xy[..., ::-1].copy()), "x_m", "exchanged"),
        (lambda r: with_points(r, lambda xy: -xy), "y_m", "sign"),
        (lambda r: with_points(r, lambda xy: 2.54 * xy), "specimen.length_m", "2.54 times too large"),
        (lambda r: with_points(r, lambda xy: 0.1 * xy), "specimen.length_m", "10 times too small"),
        (far_camera, "camera.m_per_px", "metres a pixel"),
    ],
    ids=["degrees", "milliseconds", "exchanged", "upside down", "inches", "a tenth", "half a pixel"],
)
def test_what_has_no_other_reading_is_refused(sound, slip, field, remedy) -> None:
    with pytest.raises(InputError) as error:
        refuse_slips(slip(sound))
    assert error.value.field == field
    assert remedy in error.value.line()


def test_a_reversed_servo_and_a_wrong_length_are_advice_with_their_numbers(sound) -> None:
    (reversed_sign,) = find_slips(with_motor(sound, -1.0))
    assert not reversed_sign.certain
    assert "sign is reversed" in reversed_sign.line()
    assert "-0." in reversed_sign.seen or "-1" in reversed_sign.seen
    (longer,) = find_slips(with_points(sound, lambda xy: 1.05 * xy))
    assert not longer.certain
    assert "147" in longer.seen  # 1.05 times 140 mm


def test_markers_out_of_order_or_out_of_reach_are_named(sound) -> None:
    markers = as_markers(sound, (0.3, 0.6, 1.0)).markers
    assert markers is not None
    turned = replace(sound, midline=None, markers=replace(markers, s=np.array([1.0, 0.6, 0.3])))
    slips = find_slips(turned)
    assert any(slip.certain and slip.field == "markers.m2.s" for slip in slips)  # the tip's marker, declared at .3
    assert any("nearer to the clamp" in slip.seen for slip in slips)
    (named,) = (slip for slip in slips if slip.field == "markers.m2.s")
    assert "fits s = 0.9" in named.remedy or "fits s = 1" in named.remedy  # it is the tip's, on an arm that bends
    assert "m2 and m0 exchanged?" in named.remedy


@pytest.mark.parametrize(
    ("factor", "certain", "named"),
    [(0.1, True, "10 times too small"), (0.001, True, "1000 times too small"), (0.394, True, "2.54 times too small")],
    ids=["a tenth", "metres as kilometres", "inches"],
)
def test_markers_that_never_leave_the_clamp_s_neighbourhood_have_a_wrong_scale(sound, factor, certain, named) -> None:
    (slip,) = find_slips(with_markers(sound, lambda xy: factor * xy))
    assert (slip.file, slip.field, slip.certain) == ("markers.csv", "x_m, y_m", certain)
    assert named in slip.remedy


def test_a_few_points_of_a_midline_have_a_scale_too(sound) -> None:
    midline = sound.midline
    assert midline is not None
    few = replace(midline, s=midline.s[::5], xy=0.1 * midline.xy[:, ::5], sigma=midline.sigma[:, ::5])
    (slip,) = find_slips(replace(sound, midline=few))
    assert slip.certain
    assert "10 times too small" in slip.remedy


def test_markers_that_are_all_too_far_have_a_wrong_scale_and_no_wrong_place(sound) -> None:
    (slip,) = (slip for slip in find_slips(with_markers(sound, lambda xy: 2.54 * xy)) if slip.certain)
    assert slip.file == "markers.csv"
    assert "2.54 times too large" in slip.remedy


@pytest.mark.parametrize("turn", [1.5, 3.0, 4.5])
@pytest.mark.parametrize("places", [(0.2, 0.4, 0.6, 0.8, 1.0), (1.0,)], ids=["five markers", "the tip alone"])
def test_an_arm_that_stays_bent_is_never_refused_for_its_scale(sound, turn, places) -> None:
    """Arcs of a circle that keep turning by so much: at 4.5 the tip is a third of the length from the clamp."""
    seen = as_markers(sound, places)
    assert seen.markers is not None
    angle, s = turn + 0.05 * np.sin(seen.markers.t)[:, None], np.array(places)
    arc = 0.14 * np.stack([(np.cos(angle * s) - 1.0) / angle, np.sin(angle * s) / angle], axis=-1)
    bent = replace(seen, motor=None, markers=replace(seen.markers, xy=arc))
    assert not any(slip.certain and slip.field == "x_m, y_m" for slip in find_slips(bent))
    if len(places) > 1:
        assert not any(slip.field == "x_m, y_m" for slip in find_slips(bent))


def with_markers(recording: Recording, change: Callable[[np.ndarray], np.ndarray]) -> Recording:
    seen = as_markers(recording, (0.3, 0.6, 1.0))
    assert seen.markers is not None
    return replace(seen, markers=replace(seen.markers, xy=change(seen.markers.xy)))


@pytest.mark.parametrize(
    ("change", "field"),
    [(lambda xy: xy[..., ::-1], "x_m"), (lambda xy: xy * [1.0, -1.0], "y_m")],
    ids=["x and y exchanged", "y reversed"],
)
def test_exchanged_and_reversed_axes_of_markers_are_refused(sound, change, field) -> None:
    with pytest.raises(InputError) as refused:
        refuse_slips(with_markers(sound, change))
    assert refused.value.field == field
    assert "degrees away from y" in str(refused.value)


def test_a_servo_against_the_markers_is_advice(sound) -> None:
    (slip,) = find_slips(with_motor(with_markers(sound, np.copy), -1.0))
    assert slip.field == "angle_rad"
    assert not slip.certain


def test_a_servo_s_log_in_milliseconds_beside_a_midline_in_seconds_is_refused(sound) -> None:
    motor = sound.motor
    with pytest.raises(InputError, match="milliseconds"):
        refuse_slips(replace(sound, motor=replace(motor, t=1e3 * motor.t)))


def test_a_servo_s_log_in_milliseconds_beside_a_film_is_refused(sound, tmp_path) -> None:
    """The film's header says how long the arm is seen: ten pictures at 30 a second are a third of a second."""
    t = np.linspace(0.0, 1.0 / 3.0, 20)
    filmed = replace(sound, midline=None, video=Video(small_video(tmp_path / "video.mp4")), load_cell=None)
    refuse_slips(replace(filmed, motor=MotorSignal(t, 0.1 * t, 0.1 * t)))
    with pytest.raises(InputError, match="milliseconds"):
        refuse_slips(replace(filmed, motor=MotorSignal(1e3 * t, 0.1 * t, 0.1 * t)))


def test_an_arm_larger_than_any_picture_is_refused(sound) -> None:
    near = Camera(60.0, 1e-6, (320.0, 80.0), (0.0, 1.0))
    with pytest.raises(InputError, match=r"1\.4e\+05"):
        refuse_slips(replace(sound, declaration=replace(sound.declaration, camera=near)))


def test_a_path_of_the_base_in_millimetres_is_refused(sound) -> None:
    """Taken off the positions, it carries the arm's points metres away from the clamp; the true path does not."""
    markers = as_markers(sound)
    assert markers.markers is not None
    t = np.linspace(markers.markers.t[0], markers.markers.t[-1], 200)
    path = np.column_stack([0.02 * np.sin(2.0 * np.pi * t), 0.0 * t])
    along = np.column_stack([np.interp(markers.markers.t, t, column) for column in path.T])
    seen = replace(markers.markers, xy=markers.markers.xy + along[:, None])
    declaration = replace(markers.declaration, seen_from="ground")
    carried = replace(markers, markers=seen, declaration=declaration, travel=BaseTravel(t, path))
    refuse_slips(carried)
    with pytest.raises(InputError) as error:
        refuse_slips(replace(carried, travel=BaseTravel(t, 1e3 * path)))
    assert "base.csv" in error.value.line()
