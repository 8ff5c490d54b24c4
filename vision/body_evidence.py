"""What speaks against a midline, by the recording's own habits: its length, its width along it, and what lies near it.

A body keeps its length and its width. Each frame is compared with the frames about it in time, and its deviation
measured by the scatter that the recording itself has (median absolute deviation): no number of any one film is built
in. Dirt that touches an end makes the body longer within a frame or two; dirt at a flank makes it wider in one place;
dirt that nearly touches an end leaves it open which of the two is the body.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import median_filter

from tentacle.signals import Array
from vision.silhouette import Axis

LENGTH_WINDOW = 31  # frames about one, whose median is its usual length
STRANGE_WIDTH = 5.0  # robust standard deviations that no honest frame is off
WIDTH_STATIONS = 26  # along the body, where widths are compared
NORMAL = 1.4826  # standard deviations to a median absolute deviation of normal noise
LEAST_UNCERTAINTY = 0.01  # relative: lengths and widths of a pixelled body are known no better
NEAR_END = 0.6  # of the body's width: dirt as near to an end as that may be a part of it
TOUCHING_GAP = 2.0  # px that a blurred gap between two bodies takes up
MIDLINE_SHIFT = 0.25  # of the width: how far aside a midline may lie for dirt at its flank
WAYS = 10  # rounds in which each body's way round is chosen
END_STATIONS = 2  # stations at either end whose width is the end's shape, not the body's


def length_doubts(axes: list[Axis | None]) -> Array:
    """How far (T,) each length is off that of the frames about it, in robust standard deviations; 0 without an axis."""
    there = np.array([axis is not None for axis in axes])
    doubts = np.zeros(len(axes))
    lengths = np.array([axis.length for axis in axes if axis is not None])
    if len(lengths) < 3:
        return doubts
    off = lengths / median_filter(lengths, min(LENGTH_WINDOW, len(lengths)), mode="nearest") - 1.0
    doubts[there] = off / _scatter(off)
    return doubts


def width_doubts(axes: list[Axis | None]) -> Array:
    """The largest deviation (T,) of a frame's width along it, in robust standard deviations; 0 without.

    The bodies are laid with the same end first: the way round in which a frame's widths are nearer to the others'.
    """
    doubts = np.zeros(len(axes))
    there = [k for k, axis in enumerate(axes) if axis is not None]
    if len(there) < 3:
        return doubts
    place = np.linspace(0.0, 1.0, WIDTH_STATIONS)
    widths = np.array(
        [np.interp(place, np.linspace(0.0, 1.0, len(axis.width)), axis.width) for axis in axes if axis is not None]
    )
    widths = _same_way(widths)
    usual = np.median(widths, axis=0)
    off = np.abs(widths - usual)[:, END_STATIONS:-END_STATIONS] / float(usual.max())
    largest = off.max(axis=1)  # among so many places one is always off: measured by what that usually is
    doubts[there] = (largest - np.median(largest)) / _scatter(largest - np.median(largest))
    doubts[there] *= 0.5 * largest > MIDLINE_SHIFT  # a midline lies half of a false width aside at most
    return doubts


def _same_way(widths: Array) -> Array:
    """Widths (T, S) with the same end first: each turned the way in which it is nearer to the median of all."""
    turned = widths
    for _ in range(WAYS):
        usual = np.median(turned, axis=0)
        nearer = np.sum((turned[:, ::-1] - usual) ** 2, axis=1) < np.sum((turned - usual) ** 2, axis=1)
        if not nearer.any():
            break
        turned = np.where(nearer[:, None], turned[:, ::-1], turned)
    return turned


def dirt_at_an_end(axis: Axis, beside: tuple[Array, ...]) -> bool:
    """Whether something else lies so near to an end that either could be the body."""
    reach = NEAR_END * float(np.quantile(axis.width, 0.9)) + TOUCHING_GAP
    return any(
        np.linalg.norm(contour - axis.points[end], axis=1).min() < reach for contour in beside for end in (0, -1)
    )


def _scatter(relative: Array) -> float:
    return max(NORMAL * float(np.median(np.abs(relative))), LEAST_UNCERTAINTY)
