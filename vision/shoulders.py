"""Where an arm leaves a block of its own grey: half way between the two inner corners of their common outline."""

from __future__ import annotations

import numpy as np

from tentacle.signals import Array
from vision.silhouette import Axis, mean_axis

SIDE = 0.3  # of the arm's width: stretch of the outline to either side, over which a corner turns
NEAR = 1.0  # widths from the place where the body gets wider: a corner there is the block's
LEAST_TURN = 0.6  # rad that an inner corner turns
STEP = 0.25  # px along the outline


def from_shoulders(contour: Array, axis: Axis, first: int) -> Array | None:
    """The arm's midline (P, 2) [px] from its base, for an axis whose point `first` is the first beyond a wider part.

    The base is half way between the inner corners; None without corners.
    """
    line = axis.points[first:]
    width = float(np.median(axis.width[len(axis.width) // 2 :])) + 2.0
    closed = np.concatenate([contour, contour[:1]])
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
    places = np.arange(0.0, arc[-1], STEP)
    even = np.stack([np.interp(places, arc, closed[:, k]) for k in (0, 1)], axis=1)
    reach = max(round(SIDE * width / STEP), 4)
    ahead, behind = np.roll(even, -reach, axis=0) - even, even - np.roll(even, reach, axis=0)
    turn = np.arctan2(behind[:, 0] * ahead[:, 1] - behind[:, 1] * ahead[:, 0], np.sum(behind * ahead, axis=1))
    inward = -turn * np.sign(turn.sum())
    along = line[min(5, len(line) - 1)] - line[0]
    away = even - line[0]
    beside = (away[:, 1] * along[0] - away[:, 0] * along[1]) / np.linalg.norm(along)
    near = np.linalg.norm(away, axis=1) < NEAR * float(axis.width[min(first, len(axis.width) - 1)])
    corners = []
    for side in (beside > 0.0, beside < 0.0):
        turns = np.where(side & near, inward, 0.0)
        if turns.max() < LEAST_TURN:
            return None
        corners.append(int(np.argmax(turns)))
    return _between(even, corners[0], corners[1], axis.points[-1])


def _between(outline: Array, one: int, other: int, tip: Array) -> Array:
    """The midline (P, 2) of the outline's part (N, 2) with the tip, closed between the two corners."""
    at = int(np.argmin(np.linalg.norm(outline - tip, axis=1)))
    count = len(outline)
    if (at - one) % count > (other - one) % count:
        one, other = other, one
    arm = outline[(one + np.arange((other - one) % count + 1)) % count]
    base = 0.5 * (arm[0] + arm[-1])
    return mean_axis(np.concatenate([base[None], arm]), 0, 1 + (at - one) % count).points
