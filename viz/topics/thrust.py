"""Thrust [N] over time: what the load cell read and, where it was computed, what the models say it should read."""

from __future__ import annotations

import rerun as rr

from tentacle.signals import LoadCellSignal
from viz.palette import MEASURED
from viz.scene import ViewedRun
from viz.topics.lines import log_line


def log_thrust(session: rr.RecordingStream, path: str, scene: ViewedRun, load_cell: LoadCellSignal | None) -> bool:
    """Whatever is known of the thrust; False where nothing is."""
    if load_cell is not None:
        log_line(session, f"{path}/thrust/measured", MEASURED, load_cell.t, load_cell.thrust)
    known = [(party, party.thrust) for party in scene.parties if party.thrust is not None]
    for party, thrust in known:
        log_line(session, f"{path}/thrust/{party.key}", party.role, scene.t, thrust)
    return load_cell is not None or bool(known)
