"""Sensors over time: what each of them read and what the models say it should read, about their means."""

from __future__ import annotations

import rerun as rr

from viz.scene import ViewedRun
from viz.topics.lines import log_line
from viz.topics.paths import sensor_path


def log_sensors(session: rr.RecordingStream, path: str, scene: ViewedRun) -> None:
    """One place for each of the run's sensors, with a line for each party that knows it."""
    for k, (name, quantity) in enumerate(scene.sensors):
        for party in scene.parties:
            if party.sensors:
                there = f"{sensor_path(path, quantity, name)}/{party.key}"
                log_line(session, there, party.role, scene.t, party.sensors[k])
