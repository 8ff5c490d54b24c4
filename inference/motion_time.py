"""The time scale of the motion that a recording shows.

    time = rms(x - mean x) / rms(x')

x: the base's angle and the mean curvature, or the markers' places, over the frames that the fit uses; of a decay, after
its release. x' is taken over two frames, and the noise's share of it, 2 sigma^2 / (2 dt)^2, is taken off. The time
depends on the data alone, so that every hypothesis is judged on the same cells of frames.
"""

from __future__ import annotations

import numpy as np

from inference.experiment import Experiment
from inference.noise_floor import noise_deviation

WIDEST = 1.5  # of the usual spacing: what lies further apart is no derivative
LEAST_SHARE = 0.1  # of the rate's square that is left where noise makes up nearly all of it


def motion_time(experiment: Experiment) -> float:
    """The time [s] of a recording's motion."""
    observation, frames = experiment.observation, experiment.used.copy()
    if experiment.release is not None:
        frames &= observation.t >= experiment.release
    t = observation.t[frames]
    seen, known = (moved[frames] for moved in observation.motion())
    seen = seen[:, np.isfinite(seen).sum(axis=0) > seen.shape[0] // 2]
    noise = np.nan_to_num(noise_deviation(seen))
    spacing = t[2:] - t[:-2]
    near = spacing < WIDEST * np.median(spacing)
    rates = [(values[2:] - values[:-2])[near] / spacing[near, None] for values in (seen, known)]
    square = np.nanmean(rates[0] ** 2, axis=0)
    square = np.maximum(square - 2.0 * noise**2 * np.mean(1.0 / spacing[near] ** 2), LEAST_SHARE * square)
    moved = np.nanvar(seen, axis=0).sum() + known.var(axis=0).sum()
    return float(np.sqrt(moved / max(square.sum() + np.sum(np.mean(rates[1] ** 2, axis=0)), 1e-300)))
