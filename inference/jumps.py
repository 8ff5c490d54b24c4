"""Frames that jump out of the motion: shown twice, stamped wrongly, or misread."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter, median_filter

from inference.observation import ShapeObservation
from tentacle.signals import Array

NEIGHBOURS = 15  # frames beside one
# How many times as far as theirs its distance is: of 36 000 sound frames of 25 simulated recordings none was 4 times
# as far, and one was 3 times.
JUMP = 4.0
OF_WAY = 0.3  # of the motion from frame to frame: what is nearer is no jump


def jumping_frames(observation: ShapeObservation) -> NDArray[np.bool_]:
    """Frames (T,) that jump out of the motion: shown twice, stamped wrongly, or misread.

    Each frame, with its base angle, is compared with the cubic in time through the two frames before and the two after
    it, in units of its own noise. Beside a frame that is missing a cubic errs by more than elsewhere, and the distance
    counts for less by as much. A frame jumps if its distance counts JUMP times as much as that of its neighbours, is at
    least OF_WAY of the motion from frame to frame, and is the largest among five frames, as it is and as it counts.
    """
    total = observation.coefficients.copy()
    total[:, 0] += observation.theta
    weights, error = _cubic(observation.t)
    beside = np.stack([total[:-4], total[1:-3], total[3:-1], total[4:]])
    between = np.einsum("it,itk->tk", weights, beside)
    stray = np.einsum("tkl,tl->tk", observation.root[2:-2], total[2:-2] - between)
    way = np.einsum("tkl,tl->tk", observation.root[2:-2], 0.5 * (total[3:-1] - total[1:-3]))
    squares, ways = np.zeros(total.shape[0]), np.zeros(total.shape[0])
    ways[2:-2] = np.sum(way**2, axis=1)
    seen = observation.seen
    whole = seen[2:-2] & seen[:-4] & seen[1:-3] & seen[3:-1] & seen[4:]
    squares[2:-2] = np.where(whole, np.sum(stray**2, axis=1), 0.0)
    farthest = squares >= maximum_filter(squares, size=5, mode="nearest")
    squares[2:-2] /= error**2
    farthest &= squares >= maximum_filter(squares, size=5, mode="nearest")
    around = median_filter(squares, size=NEIGHBOURS, mode="nearest")
    return farthest & (squares > OF_WAY**2 * ways) & (squares > JUMP**2 * np.maximum(around, 2.0 * total.shape[1]))


def _cubic(t: Array) -> tuple[Array, Array]:
    """Weights (4, T - 4) of the two frames before and the two after each in the cubic through them, and how much more
    the cubic errs (T - 4,) than between equal steps. It is truncated by the fourth derivative times the product of the
    four distances in time, over 24; its noise is the root of 1 plus the squares of the weights.
    """
    away = np.stack([t[:-4], t[1:-3], t[3:-1], t[4:]]) - t[2:-2]
    others = [[away[j] for j in range(4) if j != i] for i in range(4)]
    weights = np.array([np.prod([far / (far - away[i]) for far in others[i]], axis=0) for i in range(4)])
    truncation, noise = np.abs(np.prod(away, axis=0)), np.sqrt(1.0 + np.sum(weights**2, axis=0))
    equal = np.sqrt(1.0 + 34.0 / 36.0)  # of the weights -1, 4, 4 and -1 sixths
    return weights, np.maximum(np.maximum(truncation / np.median(truncation), noise / equal), 1.0)


def without_jumps(observation: ShapeObservation) -> tuple[ShapeObservation, int]:
    """The observation without jumping frames (their weight is 0), and their number."""
    if observation.t.size < NEIGHBOURS:
        return observation, 0
    jumping = jumping_frames(observation)
    return observation.without(jumping), int(jumping.sum())
