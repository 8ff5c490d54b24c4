"""Thrust [N] over time: what the load cell read and, where it was computed, what the models say it should read."""

from __future__ import annotations

import rerun as rr

from tentacle.diagnosis import RunComparison
from tentacle.signals import LoadCellSignal
from viz.palette import AUGMENTED, BASE, MEASURED
from viz.topics.lines import log_line


def log_thrust(session: rr.RecordingStream, path: str, run: RunComparison, load_cell: LoadCellSignal | None) -> bool:
    """Whatever is known of the thrust; False where nothing is."""
    if load_cell is not None:
        log_line(session, f"{path}/thrust/measured", MEASURED, load_cell.t, load_cell.thrust)
    for name, role, thrust in (("base", BASE, run.thrust_base), ("augmented", AUGMENTED, run.thrust_augmented)):
        if thrust is not None:
            log_line(session, f"{path}/thrust/{name}", role, run.t, thrust)
    return load_cell is not None or run.thrust_base is not None or run.thrust_augmented is not None
