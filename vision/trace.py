"""An arm's course from its base, found step by step, for shapes that the coarse search over low polynomials misses.

Chains of steps of equal length start at the base; each step may turn a little against the last one. A chain's score is
the mean over its steps of the weaker side's contrast, as in locate, minus a penalty on its turns. Of chains that end in
the same cell with the same heading, the best is kept (a beam search: dynamic programming on a lattice).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tentacle.compiled import njit
from tentacle.signals import Array
from vision.kinematics import Geometry
from vision.lens import bend_point

HEADINGS = 24
TURNS = np.linspace(-0.5, 0.5, 11)  # rad, of a step against the last
BENT = 0.4  # penalty of a turn of one radian; smaller turns by the power 3/2
MOST_CHAINS = 250  # chains that are kept
CELL, HEADING = 1.5, 0.25  # reduced px, rad: chains closer than that are one
COORDINATE_PRIOR = 1e-4  # prior information on each coordinate, against the squares of STEPS headings


class Reduced(NamedTuple):
    """A picture reduced shrink times, and the lens of the whole one."""

    image: NDArray[np.float32]
    shrink: float
    lens: Array


class Bar(NamedTuple):
    """Geometry of a chain: from base (2,) [px], with unit vectors axes (2, 2), normal and arm, in steps [px], with
    radius (STEPS,) [px]."""

    base: Array
    axes: Array
    step: float
    radius: Array


@njit(cache=True, nogil=True)
def _beside(picture: Reduced, place: tuple[float, float], n: Array, r: float, polarity: float) -> float:
    """The weaker side's contrast [grey] of a bar at a place [px] whose normal is n; NaN outside the picture."""
    image, shrink, lens = picture
    u, v = place
    height, width = image.shape
    levels = np.empty(3)
    for k in range(3):
        distance = 0.0 if k == 0 else (r + 3.0 * shrink) * (1.0 if k == 1 else -1.0)
        a, b = bend_point(u + distance * n[0], v + distance * n[1], lens)
        a, b = (a + 0.5) / shrink - 0.5, (b + 0.5) / shrink - 0.5
        column, row = int(a + 0.5), int(b + 0.5)
        if a < 0 or b < 0 or column >= width or row >= height:
            return np.nan
        levels[k] = image[row, column]
    return min(polarity * (levels[1] - levels[0]), polarity * (levels[2] - levels[0]))


@njit(cache=True, nogil=True)
def _chains(picture: Reduced, bar: Bar, first: Array, scale: float, polarity: float) -> Array:
    """Headings (STEPS,) [rad] of the best chain; first (F,) [rad]: headings that its first step may have."""
    base, axes, step, radius = bar
    turns, shrink = TURNS, picture.shrink
    steps = len(radius)
    room = MOST_CHAINS * len(turns) + len(first) * len(turns)
    place, heading, merit = np.empty((room, 2)), np.empty(room), np.empty(room)
    history = np.zeros((steps, MOST_CHAINS), dtype=np.int64)
    headings = np.zeros((steps, MOST_CHAINS))
    count = len(first)
    now_place, now_heading, now_merit = np.empty((room, 2)), np.empty(room), np.zeros(room)
    parent = np.empty(room, dtype=np.int64)
    for k in range(count):
        now_place[k], now_heading[k] = base, first[k]
    normal = np.empty(2)
    for level in range(steps):
        made = 0
        for k in range(count):
            for turn in turns:
                if level == 0 and turn != 0.0:
                    continue
                angle = now_heading[k] + turn
                sine, cosine = np.sin(angle), np.cos(angle)
                u = now_place[k, 0] + step * (-sine * axes[0, 0] + cosine * axes[1, 0])
                v = now_place[k, 1] + step * (-sine * axes[0, 1] + cosine * axes[1, 1])
                normal[0] = cosine * axes[0, 0] + sine * axes[1, 0]
                normal[1] = cosine * axes[0, 1] + sine * axes[1, 1]
                seen = _beside(picture, (u, v), normal, radius[level], polarity)
                gain = -0.3 if np.isnan(seen) else np.tanh(seen / scale)
                place[made, 0], place[made, 1], heading[made] = u, v, angle
                merit[made] = now_merit[k] + gain - BENT * abs(turn) ** 1.5
                parent[made] = k
                made += 1
        order = np.argsort(-merit[:made])
        kept = 0
        for place_in_order in range(made):
            k = order[place_in_order]
            alike = False
            for other in range(kept):
                far = max(abs(now_place[other, 0] - place[k, 0]), abs(now_place[other, 1] - place[k, 1]))
                if far < CELL * shrink and abs(now_heading[other] - heading[k]) < HEADING:
                    alike = True
                    break
            if alike:
                continue
            now_place[kept], now_heading[kept], now_merit[kept] = place[k], heading[k], merit[k]
            history[level, kept], headings[level, kept] = parent[k], heading[k]
            kept += 1
            if kept == MOST_CHAINS:
                break
        count = kept
    course = np.empty(steps)
    at = 0
    for level in range(steps - 1, -1, -1):
        course[level] = headings[level, at]
        at = history[level, at]
    return course


def trace(
    picture: Reduced,
    geometry: Geometry,
    shared: Array,
    theta: float | None,
    contrast: tuple[float, float],
    size: int,
) -> Array:
    """The shape x (size,) [rad], offset first, of the best chain from the base; theta None: every direction is
    possible. contrast: scale [grey] of the contrast in the score, and the polarity (+1 dark arm).
    """
    s = (np.arange(HEADINGS) + 0.5) / HEADINGS
    radius = np.interp(s + 0.5 / HEADINGS, np.linspace(0.0, 1.0, len(geometry.radius)), geometry.radius_at(shared))
    first = np.linspace(-0.5, 0.5, 9) + theta if theta is not None else np.linspace(-np.pi, np.pi, 48, endpoint=False)
    axes, step = np.array([geometry.normal, geometry.arm]), geometry.length * (1.0 + shared[2]) / HEADINGS
    bar = Bar(geometry.base + shared[:2], axes, step, radius)
    headings = _chains(picture, bar, first, *contrast)
    design = np.array([np.ones(HEADINGS), *(s**k / k for k in range(1, size))]).T
    right = design.T @ (headings - (theta or 0.0))
    return np.asarray(np.linalg.solve(design.T @ design + COORDINATE_PRIOR * np.eye(size), right), dtype=float)
