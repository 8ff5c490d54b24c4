"""The visible length of an arm, along its fitted course and beyond it along possible arcs of the tip.

The sides hardly determine the length, because the coordinates of a curve can be counted from any point; the tip
determines it. Several arcs leave the fitted course shortly before its end. The arc with the largest sum (contrast /
usual - HALF) ds is taken, and the arm ends where this sum is largest.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

from tentacle.signals import Array
from vision.edge_look import EdgeLook
from vision.edges import grey_at
from vision.kinematics import Geometry

FROM, AHEAD, STEPS = 0.82, 0.4, 40  # start of the search, its length beyond the end (of the arm), steps
HEADINGS = np.linspace(-0.3, 0.3, 5)  # rad by which an arc may leave the fitted course
BENDS = np.linspace(-6.0, 6.0, 17)  # rad per arm's length: the arcs' curvature
BORDER = 4  # steps beyond the end that must be in the picture
HALF = 0.45  # of the usual contrast: less counts as ground
MARGIN = 4.0  # px beyond the sides: place of the ground's grey


def seen_reach(
    image: NDArray[np.uint8],
    geometry: Geometry,
    course: tuple[Array, Array],
    shared: Array,
    sight: EdgeLook,
    begin_at: float = FROM,
) -> tuple[float, float]:
    """Share of its length up to which an arm is seen, and the distance [px] of the fitted course there. The search
    begins at the share begin_at. Both are NaN if the picture's border is too near.

    course: the fitted centre points (S + 1, 2) [px] and headings (S + 1,) [rad].
    """
    centre, phi = course
    length = geometry.length * (1.0 + shared[2])
    begin = round(begin_at * (len(centre) - 1))
    ahead = (np.arange(STEPS) + 0.5) * AHEAD / STEPS
    s = begin_at + ahead
    radius = np.interp(np.minimum(s, 1.0), np.linspace(0.0, 1.0, len(centre)), geometry.radius_at(shared))
    turn, bend = (grid.ravel()[:, None] for grid in np.meshgrid(HEADINGS, BENDS))
    heading = phi[begin] + turn + bend * ahead  # (arcs, STEPS)
    along = np.cos(heading)[..., None] * geometry.arm - np.sin(heading)[..., None] * geometry.normal
    across = np.cos(heading)[..., None] * geometry.normal + np.sin(heading)[..., None] * geometry.arm
    step = length * AHEAD / STEPS
    middle = centre[begin] + step * (np.cumsum(along, axis=1) - 0.5 * along)
    beside = (radius + MARGIN)[:, None] * across
    probes = np.stack([middle, middle + beside, middle - beside])
    grey = grey_at(image, geometry.lens.packed, np.ascontiguousarray(probes.reshape(-1, 2))).reshape(probes.shape[:3])
    contrast = np.minimum(sight.polarity * (grey[1] - grey[0]), sight.polarity * (grey[2] - grey[0]))
    usual = sight.contrast_at(np.minimum(s, 1.0)) * erf(radius / (np.sqrt(2.0) * sight.blur))
    gathered = np.cumsum(np.clip(contrast / usual, -1.0, 1.0) - HALF, axis=1)
    most = np.nan_to_num(gathered, nan=-1.0).max(axis=1)
    best = int(np.argmax(most))
    if most[best] <= 0.0:
        return begin_at, 0.0
    end = int(np.nanargmax(gathered[best]))
    if end + BORDER >= STEPS or not np.isfinite(gathered[best, end + BORDER]):
        return np.nan, np.nan
    inside = min(end, int(np.searchsorted(s, 1.0)) - 1)
    off = float(np.linalg.norm(centre[begin:] - middle[best, inside], axis=1).min())
    return float(s[end] + 0.5 * step / length), off
