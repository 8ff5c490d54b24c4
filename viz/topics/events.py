"""The event log of a run, from its own data: a text at an instant, with a level."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np
import rerun as rr

from tentacle.recording import Recording
from viz.scene import ViewedRun
from viz.topics.paths import seconds

Level = Literal["INFO", "WARN", "ERROR"]


@dataclass(frozen=True)
class Event:
    """Something that happened at t [s]: settling, a retry, a fault, a rejected frame."""

    t: float
    level: Level
    text: str


def recording_events(recording: Recording) -> list[Event]:
    """The release of a free decay, and every frame that the vision rejected, with its reason."""
    events = []
    if recording.declaration.release_t is not None:
        events.append(Event(recording.declaration.release_t, "INFO", "released: free decay from here"))
    if recording.shape is not None:
        events += [
            Event(float(t), "WARN", f"frame rejected: {reason}")
            for t, accepted, reason in zip(
                recording.shape.t, recording.shape.accepted, recording.shape.reason, strict=True
            )
            if not accepted
        ]
    return events


def judged_events(scene: ViewedRun) -> list[Event]:
    """Where the errors begin and cease to be judged; nothing where that is everywhere."""
    if scene.judged.all():
        return []
    edges = np.diff(scene.judged.astype(int), prepend=0)
    starts = [Event(float(t), "INFO", "errors are judged from here") for t in scene.t[edges == 1]]
    stops = [Event(float(t), "INFO", "errors are not judged from here") for t in scene.t[edges == -1]]
    return starts + stops


def log_events(session: rr.RecordingStream, path: str, events: Iterable[Event]) -> bool:
    """The events in order of time; False where there are none."""
    ordered = sorted(events, key=lambda event: event.t)
    if not ordered:
        return False
    columns = rr.TextLog.columns(text=[f"{e.t:.3f} s  {e.text}" for e in ordered], level=[e.level for e in ordered])
    session.send_columns(f"{path}/events", [seconds(np.array([e.t for e in ordered]))], columns)
    return True
