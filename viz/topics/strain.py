"""Strain over time: what each gauge read and what the models say it should read, about their means."""

from __future__ import annotations

import rerun as rr

from viz.scene import ViewedRun
from viz.topics.lines import log_line
from viz.topics.paths import gauge_path


def log_strain(session: rr.RecordingStream, path: str, scene: ViewedRun) -> None:
    """One place for each of the run's gauges, with a line for each party that knows it."""
    for k, gauge in enumerate(scene.gauges):
        for party in scene.parties:
            if party.strain is not None:
                log_line(session, f"{gauge_path(path, gauge)}/{party.key}", party.role, scene.t, party.strain[:, k])
