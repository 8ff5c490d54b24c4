"""Sessions of a recording by itself: the video with what was seen over it, rejected frames marked, q with its bands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import rerun.blueprint as rrb

from tentacle.errors import InputError
from tentacle.recording import Recording
from tentacle.signals import Array
from viz.blueprints.run import run_page
from viz.blueprints.views import blueprint_page
from viz.midline import DRAWN_POINTS, paper_coordinates, track_points
from viz.palette import MEASURED
from viz.scene import Party, ViewedRun
from viz.session import log_scene, session_file, session_id, set_layout
from viz.topics.events import Event
from viz.topics.paths import run_path
from viz.topics.sensors import log_readings


def servo_angle(recording: Recording, t: Array) -> Array:
    """The servo's measured angle theta (T,) [rad] at times t; 0 where the base is clamped."""
    if recording.motor is None:
        return np.zeros_like(t)
    return np.interp(t, recording.motor.t, recording.motor.angle)


def track_scene(recording: Recording) -> ViewedRun:
    """What vision measured of a recording, as a scene with one party. Raises InputError where there is no track."""
    shape = recording.shape
    if shape is None:
        raise InputError("has not been tracked", field=recording.name, expected="a recording with shapes")
    theta = servo_angle(recording, shape.t)
    s = np.linspace(0.0, 1.0, DRAWN_POINTS)
    xy = track_points(shape, theta, recording.declaration.specimen.length, s)
    xy[~shape.accepted] = np.nan
    q, _ = paper_coordinates(shape)
    everywhere = np.ones(len(shape.t), dtype=bool)
    return ViewedRun(recording.name, shape.t, s, theta, (Party("measured", MEASURED, xy, q),), everywhere)


def recording_scene(recording: Recording) -> ViewedRun:
    """Whatever a recording shows of the arm, as a scene with one party: its track, midline or markers.

    Of a video that was not tracked the scene has the servo's times, with nothing seen.
    """
    if recording.shape is not None:
        return track_scene(recording)
    if recording.midline is not None:
        t, s, xy, points = recording.midline.t, recording.midline.s, recording.midline.xy, "midline"
    elif recording.markers is not None:
        t, s, xy, points = recording.markers.t, recording.markers.s, recording.markers.xy, "markers"
    else:
        t = np.zeros(1) if recording.motor is None else recording.motor.t
        s, xy, points = np.linspace(0.0, 1.0, 2), np.full((len(t), 2, 2), np.nan), "midline"
    everywhere = np.ones(len(t), dtype=bool)
    party = Party("measured", MEASURED, xy)
    return ViewedRun(recording.name, t, s, servo_angle(recording, t), (party,), everywhere, points)


def write_recording_view(recording: Recording, path: Path | str, events: Sequence[Event] = ()) -> Path:
    """A session that shows a recording as it is, with what else happened. InputError where its video cannot be read."""
    path = Path(path)
    with session_file(path, session_id("view", recording.name)) as session:
        shown = log_scene(session, recording_scene(recording), recording, events)
        shown = replace(shown, sensors=log_readings(session, run_path(shown.name), recording))
        set_layout(session, blueprint_page(rrb.Tabs(run_page(shown))))
    return path
