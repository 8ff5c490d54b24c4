"""Entity paths and the one time line: every run lives under runs/<name>, on its own clock, in seconds."""

from __future__ import annotations

import rerun as rr

from tentacle.signals import Array

TIMELINE = "time"


def run_path(name: str) -> str:
    """Where a run's entities live; characters that a path cannot hold are escaped."""
    return f"runs/{rr.escape_entity_path_part(name)}"


def sensor_path(run: str, quantity: str, sensor: str) -> str:
    """Where the lines of one sensor of a run live."""
    return f"{run}/{quantity}/{rr.escape_entity_path_part(sensor)}"


def seconds(t: Array) -> rr.TimeColumn:
    """The time column of columns sent at times t (T,) [s]."""
    return rr.TimeColumn(TIMELINE, duration=t)
