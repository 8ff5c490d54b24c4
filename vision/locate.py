"""Finds the arm without an earlier frame: a coarse search over shapes, scored by local contrast on both sides."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from tentacle.compiled import njit
from tentacle.signals import Array
from vision.kinematics import Geometry
from vision.lens import bend_point
from vision.trace import Reduced, trace

COARSE_LENGTH = 120.0  # px, length of the arm in the reduced picture
LOCATED_STATIONS = 20
END_ANGLES = np.linspace(-2.4, 2.4, 17)  # rad, alpha(1) = q1 + q2/2
BENDS = np.linspace(-6.0, 6.0, 11)  # rad, q2
KNOWN_OFFSETS = np.linspace(-0.4, 0.4, 9)  # rad about the motor's angle
CERTAIN = 0.9  # score of offset, q1 and q2 above which the search ends
ANY_OFFSETS = np.arange(60) * (2.0 * np.pi / 60) - np.pi


@dataclass(frozen=True)
class Located:
    """A coarse shape x = [offset, q1, q2, ..] [rad], polarity (+1 dark arm), score in -1 to 1: mean local contrast."""

    x: Array
    polarity: float
    score: float


class View(NamedTuple):
    """The picture reduced shrink times, its lens, and the arm in it: base (2,) [px], unit vectors normal and arm (2,),
    length [px], radius (STATIONS,) [px], base angle theta [rad]."""

    image: NDArray[np.float32]
    shrink: float
    lens: Array
    base: Array
    normal: Array
    arm: Array
    length: float
    radius: Array
    theta: float


@njit(cache=True)
def _score(view: View, shape: Array, scale: float, polarity: float) -> float:
    """Mean over stations of tanh of the weaker side's contrast, with the ground beyond the tip."""
    image, shrink, lens, base, normal, arm, length, radius, theta = view
    height, width = image.shape
    count = radius.shape[0]
    u, v = base[0], base[1]
    total, weights = 0.0, 0.0
    step = length / count
    for i in range(count + 1):
        s = (i + 0.5) / count if i < count else 1.0
        half = (i + 0.25) / count  # angle at the middle of the step to this station
        angle, middle, power, half_power = theta + shape[0], theta + shape[0], 1.0, 1.0
        for k in range(1, len(shape)):
            power, half_power = power * s, half_power * half
            angle += shape[k] * power / k
            middle += shape[k] * half_power / k
        stride = 0.5 * step if i in (0, count) else step
        u += stride * (-np.sin(middle) * normal[0] + np.cos(middle) * arm[0])
        v += stride * (-np.sin(middle) * normal[1] + np.cos(middle) * arm[1])
        n_u = np.cos(angle) * normal[0] + np.sin(angle) * arm[0]
        n_v = np.cos(angle) * normal[1] + np.sin(angle) * arm[1]
        levels = np.empty(3)
        r = radius[min(i, count - 1)]
        if i == count:  # beyond the tip
            n_u, n_v = (
                -np.sin(angle) * normal[0] + np.cos(angle) * arm[0],
                -np.sin(angle) * normal[1] + np.cos(angle) * arm[1],
            )
        lost = False
        for k in range(3):
            distance = 0.0 if k == 0 else (r + 3.0 * shrink) * (1.0 if k == 1 else -1.0)
            if i == count and k > 0:
                distance = 5.0 * shrink
            if i == count and k == 0:
                distance = -3.0 * shrink
            a, b = bend_point(u + distance * n_u, v + distance * n_v, lens)
            a, b = (a + 0.5) / shrink - 0.5, (b + 0.5) / shrink - 0.5
            column, row = int(a + 0.5), int(b + 0.5)
            if a < 0 or b < 0 or column >= width or row >= height:
                lost = True
                break
            levels[k] = image[row, column]
        weights += 1.0
        if lost:
            total -= 0.3
            continue
        weaker = min(polarity * (levels[1] - levels[0]), polarity * (levels[2] - levels[0]))
        total += np.tanh(weaker / scale)
    return total / weights


@njit(cache=True)
def _search(view: View, shapes: Array, scale: float, polarity: float) -> Array:
    scores = np.empty(shapes.shape[0])
    for k in range(shapes.shape[0]):
        scores[k] = _score(view, shapes[k], scale, polarity)
    return scores


def locate(
    image: NDArray[np.uint8],
    geometry: Geometry,
    shared: Array,
    theta: float | None,
    polarities: tuple[float, ...] = (1.0, -1.0),
    coordinates: int = 3,
) -> Located:
    """The best coarse shape of an arm with a known base; theta None: every direction is possible. coordinates: number
    for a course traced from the base, which is used if it explains the picture better than offset, q1 and q2.

    With a score above about 0.5, both sides have contrast with the ground along most of the arm.
    """
    shrink = max(geometry.length / COARSE_LENGTH, 1.0)
    size = (max(int(image.shape[1] / shrink), 1), max(int(image.shape[0] / shrink), 1))
    small = cv2.GaussianBlur(cv2.resize(image, size, interpolation=cv2.INTER_AREA), (0, 0), 1.0).astype(np.float32)
    low, high = np.percentile(small, [2.0, 98.0])
    s = (np.arange(LOCATED_STATIONS) + 0.5) / LOCATED_STATIONS
    radius = np.interp(s, np.linspace(0.0, 1.0, len(geometry.radius)), geometry.radius_at(shared))
    view = View(
        small, shrink, geometry.lens.packed, geometry.base + shared[:2], geometry.normal, geometry.arm,
        geometry.length * (1.0 + shared[2]), radius, theta or 0.0,
    )  # fmt: skip
    contrast = max(0.1 * float(high - low), 4.0)
    offsets = ANY_OFFSETS if theta is None else KNOWN_OFFSETS
    grid = np.array(np.meshgrid(offsets, END_ANGLES, BENDS, indexing="ij")).reshape(3, -1).T
    shapes = np.column_stack([grid[:, 0], grid[:, 1] - 0.5 * grid[:, 2], grid[:, 2]]).astype(float)
    best = Located(shapes[0], polarities[0], -1.0)
    for polarity in polarities:
        scores = _search(view, shapes, contrast, polarity)
        start = shapes[np.argsort(scores)[::-1][:12]]
        width = np.array([0.05, 0.15, 0.6])
        rng = np.random.default_rng(0)
        for _ in range(5):  # a shrinking cloud around the best few
            cloud = np.concatenate(
                [start, (start[:, None] + width * rng.standard_normal((len(start), 40, 3))).reshape(-1, 3)]
            )
            scores = _search(view, cloud, contrast, polarity)
            start = cloud[np.argsort(scores)[::-1][:8]]
            width *= 0.6
        if scores.max() > best.score:
            best = Located(start[0], polarity, float(scores.max()))
        if coordinates > 3 and scores.max() < CERTAIN:
            picture = Reduced(small, shrink, geometry.lens.packed)
            traced = trace(picture, geometry, shared, theta, (contrast, polarity), coordinates)
            score = float(_search(view, traced[None], contrast, polarity)[0])
            if score > best.score:
                best = Located(traced, polarity, score)
    return best
