"""The points at which a recording shows the arm, on the axis or beside it, from any kind of measurement."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from affine_model.curvature import midline
from tentacle.errors import InputError
from tentacle.recording import Recording
from tentacle.signals import Array

TRACKED_POINTS = np.linspace(0.05, 1.0, 20)  # places on the axis at which a tracked shape is evaluated


@dataclass(frozen=True)
class ObservedPoints:
    """Points (s, d) of the arm over time: t (T,) [s], s (P,), d (P,) [m] along the normal, xy (T, P, 2) [m], NaN where
    not seen. camera: whether the clamp's place in the picture is uncertain.
    """

    t: Array
    s: Array
    d: Array
    xy: Array
    camera: bool


def observed_points(recording: Recording) -> ObservedPoints:
    """The points of a recording; InputError where it shows none."""
    if recording.midline is not None:
        line = recording.midline
        return ObservedPoints(line.t, line.s, np.zeros(len(line.s)), line.xy, True)
    if recording.markers is not None:
        marks = recording.markers
        return ObservedPoints(marks.t, marks.s, marks.d, marks.xy, False)
    if recording.shape is not None and recording.motor is not None:
        shape, motor = recording.shape, recording.motor
        theta = np.interp(shape.t, motor.t, motor.angle) + shape.coefficients[:, 0]
        length = recording.declaration.specimen.length * shape.scale
        xy = midline(shape.coefficients[:, 1:], theta, length, TRACKED_POINTS) + shape.base_shift
        xy[~shape.accepted] = np.nan
        return ObservedPoints(shape.t, TRACKED_POINTS, np.zeros(len(TRACKED_POINTS)), xy, True)
    raise InputError("shows no midline and no markers", field=recording.name, expected="a recording that was tracked")
