"""The mean axis of a slender body from its contour: where its flat base and its tip are, and where a clamp ends."""

from __future__ import annotations

import numpy as np

from tentacle.signals import Array
from vision.silhouette import Axis, mean_axis

LEAST_SLENDERNESS = 3.0  # least length over width of an arm
TAPER = slice(0.35, 0.9)  # of the length: range in which the arm's own widths are measured
WIDER = 1.35  # times the arm's own width: beyond it is a clamp or a trunk
CORNER_ANGLE = 0.7  # rad, least turn of the contour at a flat end
CONTOUR_POINTS = 120


def axis_between(contour: Array, first: int, last: int) -> Axis | None:
    """Mean axis between two points of the contour; None if the body is not slender."""
    if first == last:
        return None
    axis = mean_axis(contour, first, last, points=CONTOUR_POINTS)
    slender = np.isfinite(axis.points).all() and axis.length > LEAST_SLENDERNESS * float(np.median(axis.width))
    return axis if slender else None


def base_opposite(contour: Array, tip: Array) -> tuple[int, int]:
    """Indices of the contour's point in the middle of the base's flat end, and of the tip.

    The base lies half the perimeter from the tip. The sides of a bent arm differ in length, so this point is not the
    middle of the base. Therefore the two corners near it are found; the middle of the base is half way between them.
    """
    at = int(np.argmin(np.linalg.norm(contour - tip, axis=1)))
    closed = np.concatenate([contour, contour[:1]])
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
    whole = float(arc[-1])
    half = float(np.mod(arc[at] + 0.5 * whole, whole))
    x, y = contour[:, 0], contour[:, 1]
    area = 0.5 * abs(float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))))
    wide = 2.0 * area / (0.5 * whole)  # of a cone, at its base
    places = half + np.linspace(-1.3 * wide, 1.3 * wide, 105)
    even = np.stack([np.interp(np.mod(places, whole), arc, closed[:, k]) for k in (0, 1)], axis=1)
    step = 10  # a quarter of the width, over which a corner turns
    ahead, behind = even[2 * step :] - even[step:-step], even[step:-step] - even[: -2 * step]
    cross = behind[:, 0] * ahead[:, 1] - behind[:, 1] * ahead[:, 0]
    turn = np.arctan2(cross, np.sum(behind * ahead, axis=1))
    turn = turn * np.sign(turn.sum())
    first = int(np.argmax(turn))
    apart = np.abs(np.arange(len(turn)) - first) > 2 * step
    second = int(np.argmax(np.where(apart, turn, -np.inf)))
    if turn[second] > CORNER_ANGLE:
        half = float(np.mod(0.5 * (places[first + step] + places[second + step]), whole))
    return int(np.argmin(np.abs(arc[:-1] - half))), at


def widths_along(axis: Axis) -> tuple[Array, Array]:
    """Widths at the axis' points (P,), and the widths there by the taper of the free part."""
    s = np.linspace(0.0, 1.0, len(axis.points))
    width = np.interp(s, np.linspace(0.0, 1.0, len(axis.width)), axis.width)
    free = (s > TAPER.start) & (s < TAPER.stop)
    taper = np.polynomial.polynomial.polyfit(s[free], width[free], 1)
    return width, np.maximum(taper[0] + taper[1] * s, 0.3 * float(np.median(width[free])))


def clamped_until(axis: Axis) -> int:
    """Index of the axis' point where the clamp ends; 0 without a clamp."""
    width, taper = widths_along(axis)
    wide = np.flatnonzero((width > WIDER * taper + 0.5)[: len(width) // 2])
    return int(wide[-1]) + 1 if len(wide) > 2 else 0
