"""The time scale of the motion that a recording shows.

    time = rms(x - mean x) / rms(x')

x: the base's angle and the mean curvature, or the markers' places, over the frames that the fit uses; of a decay, after
its release. x' is taken over two frames, and the noise's share of it, 2 sigma^2 / (2 dt)^2, is taken off. The time
depends on the data alone, so that every hypothesis is judged on the same cells of frames.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from affine_model.curvature import Array
from inference.experiment import Experiment
from inference.noise_floor import noise_deviation

WIDEST = 1.5  # of the usual spacing: what lies further apart is no derivative
LEAST_SHARE = 0.1  # of the rate's square that is left where noise makes up nearly all of it


def motion_time(experiment: Experiment) -> float:
    """The time [s] of a recording's motion."""
    observation, frames = experiment.observation, experiment.used.copy()
    if experiment.release is not None:
        frames &= observation.t >= experiment.release
    seen, known = _seen_and_known(experiment, frames)
    noise = np.nan_to_num(noise_deviation(seen))
    _, spacing, rates = _rates(observation.t[frames], (seen, known))
    square = np.nanmean(rates[0] ** 2, axis=0)
    square = np.maximum(square - 2.0 * noise**2 * np.mean(1.0 / spacing**2), LEAST_SHARE * square)
    moved = np.nanvar(seen, axis=0).sum() + known.var(axis=0).sum()
    return float(np.sqrt(moved / max(square.sum() + np.sum(np.mean(rates[1] ** 2, axis=0)), 1e-300)))


def moved_until(experiment: Experiment, share: float) -> float:
    """The instant [s] by which that share of the integral of |x'|^2 over the frames of the fit has passed."""
    t = experiment.observation.t[experiment.used]
    at, _, rates = _rates(t, _seen_and_known(experiment, experiment.used))
    passed = np.cumsum(sum(np.nansum(one**2, axis=1) for one in rates))
    return float(at[min(np.searchsorted(passed, share * passed[-1]), at.size - 1)])


def _seen_and_known(experiment: Experiment, frames: NDArray[np.bool_]) -> tuple[Array, Array]:
    """What moves (F, K), and the base (F, 1), on these frames; a marker that is hidden on most of them is left out."""
    seen, known = (moved[frames] for moved in experiment.observation.motion())
    return seen[:, np.isfinite(seen).sum(axis=0) > seen.shape[0] // 2], known


def _rates(t: Array, moved: tuple[Array, ...]) -> tuple[Array, Array, list[Array]]:
    """Instants (F',), the time between the two frames that each rate is taken over, and the rates (F', K) of each."""
    spacing = t[2:] - t[:-2]
    near = spacing < WIDEST * np.median(spacing)
    rates = [(values[2:] - values[:-2])[near] / spacing[near, None] for values in moved]
    return t[1:-1][near], spacing[near], rates
