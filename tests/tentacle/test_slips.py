"""Slips of sign, unit and order are found; recordings without one pass."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from tentacle.errors import InputError
from tentacle.recording import Camera, Recording
from tentacle.slips import find_slips, refuse_slips
from tests.made_recordings import as_markers


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
        (lambda r: with_points(r, lambda xy: 2.54 * xy), "specimen.length_m", "one length"),
        (far_camera, "camera.m_per_px", "metres a pixel"),
    ],
    ids=["degrees", "milliseconds", "exchanged", "upside down", "inches", "half a pixel"],
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
