"""Sensors over time: what each of them read, and what the models say it should read."""

from __future__ import annotations

import rerun as rr

from tentacle.diagnosis import Quantity
from tentacle.recording import Recording
from tentacle.signals import AccelerationSignal, StrainSignal
from viz.palette import MEASURED
from viz.scene import ViewedRun
from viz.topics.lines import log_line
from viz.topics.paths import sensor_path


def log_sensors(session: rr.RecordingStream, path: str, scene: ViewedRun) -> None:
    """One place for each of the run's sensors, with a line about its mean for each party that knows it."""
    for k, (name, quantity) in enumerate(scene.sensors):
        for party in scene.parties:
            if party.sensors:
                there = f"{sensor_path(path, quantity, name)}/{party.key}"
                log_line(session, there, party.role, scene.t, party.sensors[k])


def log_readings(session: rr.RecordingStream, path: str, recording: Recording) -> tuple[tuple[str, Quantity], ...]:
    """Every reading of the recording's sensors as it came; the sensors (name, quantity)."""
    found: list[tuple[str, Quantity]] = []
    signals: tuple[tuple[Quantity, StrainSignal | AccelerationSignal | None], ...] = (
        ("strain", recording.strain),
        ("acceleration", recording.acceleration),
    )
    for quantity, signal in signals:
        if signal is None:
            continue
        for k, name in enumerate(signal.names):
            there = f"{sensor_path(path, quantity, name)}/{MEASURED.name}"
            log_line(session, there, MEASURED, signal.t, signal.values[:, k])
            found.append((name, quantity))
    return tuple(found)
