"""The paper's coordinates q1, q2 over time, measured (with their 95 % band) and modelled."""

from __future__ import annotations

import numpy as np
import rerun as rr

from tentacle.signals import Array, ShapeTrack
from viz.midline import paper_coordinates
from viz.palette import MEASURED
from viz.scene import ViewedRun
from viz.topics.lines import log_band, log_line

NORMAL_95 = 1.959964  # two-sided 95 % quantile of the normal distribution


def coordinate_sigma(shape: ShapeTrack, t: Array) -> Array:
    """Standard deviations (T, 2) [rad] of the paper's q1 and q2 at times t, from the track; NaN outside it."""
    _, sigma = paper_coordinates(shape)
    present = np.isfinite(sigma).all(axis=1)
    if not present.any():
        return np.full((len(t), 2), np.nan)
    columns = [np.interp(t, shape.t[present], column, left=np.nan, right=np.nan) for column in sigma[present].T]
    return np.stack(columns, axis=1)


def log_coordinates(session: rr.RecordingStream, path: str, scene: ViewedRun, shape: ShapeTrack | None) -> None:
    """q1 and q2 [rad] of every party that has them, and the servo's angle theta [rad]."""
    for party in scene.parties:
        if party.q is None:
            continue
        for index in (1, 2):
            where, values = f"{path}/q{index}/{party.key}", party.q[:, index - 1]
            log_line(session, where, party.role, scene.t, values)
            if party is scene.subject and shape is not None:
                half_width = NORMAL_95 * coordinate_sigma(shape, scene.t)[:, index - 1]
                log_band(session, where, party.role, scene.t, values, half_width)
    log_line(session, f"{path}/theta", MEASURED, scene.t, scene.theta)
