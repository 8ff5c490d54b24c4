"""Evidence against a midline, from the recording itself: unusual length, unusual width, and objects near the body.

A body keeps its length and its width. Each frame is compared with the frames around it in time. The unit of its
deviation is the recording's own scatter (median absolute deviation), so no number of a particular film is built in.
Dirt that touches an end makes the body longer within one or two frames. Dirt at a flank makes it wider in one place.
With dirt that nearly touches an end, it is not clear which of the two is the body.
"""

from __future__ import annotations

import numpy as np
from scipy.ndimage import median_filter

from tentacle.signals import Array
from vision.silhouette import Axis

LENGTH_WINDOW = 31  # frames around a frame, whose median is the usual length
STRANGE_WIDTH = 5.0  # robust standard deviations: a frame with a larger deviation is rejected
WIDTH_STATIONS = 26  # along the body, where widths are compared
NORMAL = 1.4826  # standard deviations to a median absolute deviation of normal noise
LEAST_UNCERTAINTY = 0.01  # relative uncertainty of length and width of a body made of pixels, at least
NEAR_END = 0.6  # of the body's width: dirt nearer to an end than this may be a part of the body
TOUCHING_GAP = 2.0  # px, the width of a blurred gap between two bodies
MIDLINE_SHIFT = 0.25  # of the width: largest shift of the midline by dirt at its flank
WAYS = 10  # rounds in which each body's direction is chosen
END_STATIONS = 2  # stations at either end whose width shows the end's shape


def length_doubts(axes: list[Axis | None]) -> Array:
    """Deviation (T,) of each length from that of the frames around it, in robust standard deviations; 0 without an
    axis.
    """
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

    All bodies are given the same direction: the one in which a frame's widths are nearer to those of the others.
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
    largest = off.max(axis=1)  # the largest of many deviations is never zero: compare with its usual size
    doubts[there] = (largest - np.median(largest)) / _scatter(largest - np.median(largest))
    doubts[there] *= 0.5 * largest > MIDLINE_SHIFT  # the midline shifts by at most half of the additional width
    return doubts


def _same_way(widths: Array) -> Array:
    """Widths (T, S) in a common direction: each is reversed if it is then nearer to the median of all."""
    turned = widths
    for _ in range(WAYS):
        usual = np.median(turned, axis=0)
        nearer = np.sum((turned[:, ::-1] - usual) ** 2, axis=1) < np.sum((turned - usual) ** 2, axis=1)
        if not nearer.any():
            break
        turned = np.where(nearer[:, None], turned[:, ::-1], turned)
    return turned


def dirt_at_an_end(axis: Axis, beside: tuple[Array, ...]) -> bool:
    """Whether another object lies so near to an end that it may be a part of the body."""
    reach = NEAR_END * float(np.quantile(axis.width, 0.9)) + TOUCHING_GAP
    return any(
        np.linalg.norm(contour - axis.points[end], axis=1).min() < reach for contour in beside for end in (0, -1)
    )


def _scatter(relative: Array) -> float:
    return max(NORMAL * float(np.median(np.abs(relative))), LEAST_UNCERTAINTY)
