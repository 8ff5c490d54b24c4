"""The paper's coordinates q1, q2 over time, measured (with their 95 % band) and modelled."""

from __future__ import annotations

import numpy as np
import rerun as rr

from tentacle.diagnosis import RunComparison
from tentacle.signals import Array, ShapeTrack
from viz.palette import AUGMENTED, BASE, MEASURED
from viz.topics.lines import log_band, log_line

NORMAL_95 = 1.959964  # two-sided 95 % quantile of the normal distribution


def coordinate_sigma(shape: ShapeTrack, index: int, t: Array) -> Array:
    """Standard deviation (T,) [rad] of q_index (1, 2 ...) at times t, from the track's covariance; NaN outside it."""
    sigma = np.sqrt(shape.covariance[:, index, index])
    present = np.isfinite(sigma)
    if not present.any():
        return np.full(len(t), np.nan)
    return np.interp(t, shape.t[present], sigma[present], left=np.nan, right=np.nan)


def log_coordinates(session: rr.RecordingStream, path: str, run: RunComparison, shape: ShapeTrack | None) -> None:
    """q1 and q2 [rad] of a run, and the servo's angle theta [rad]."""
    for index in (1, 2):
        where = f"{path}/q{index}"
        log_line(session, f"{where}/measured", MEASURED, run.t, run.q_measured[:, index - 1])
        log_line(session, f"{where}/base", BASE, run.t, run.q_base[:, index - 1])
        log_line(session, f"{where}/augmented", AUGMENTED, run.t, run.q_augmented[:, index - 1])
        if shape is not None and shape.coefficients.shape[1] > index:
            half_width = NORMAL_95 * coordinate_sigma(shape, index, run.t)
            log_band(session, f"{where}/measured", MEASURED, run.t, run.q_measured[:, index - 1], half_width)
    log_line(session, f"{path}/theta", MEASURED, run.t, run.theta)
