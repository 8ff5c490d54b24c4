"""From a picture to a body's silhouette and its mean axis, without a model of the shape and without a clamp."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from tentacle.signals import Array

ENLARGE = 4  # a threshold on the enlarged picture places the contour between pixels
LONGEST_ENLARGED = 1600  # px; larger pictures are not enlarged
FAINT_SHARE = 0.8  # share of the body's pixels that are darker than its faint parts
SPECK = 3.0  # px^2: less is noise
END_WINDOW = 0.04  # of the contour's length: extent of an end
SIDE_POINTS = 200


@dataclass(frozen=True)
class Silhouette:
    """Outer contour (C, 2) [px] of the largest body, its area and that of its holes [px^2], polarity (+1 dark).

    beside: outer contours of other objects that are larger than noise.
    """

    contour: Array
    area: float
    holes: float
    polarity: float
    beside: tuple[Array, ...] = ()


@dataclass(frozen=True)
class Axis:
    """Mean axis (P, 2) [px], equally spaced from one end to the other, full width (P,) and length [px]."""

    points: Array
    width: Array
    length: float


def silhouette(image: NDArray[np.uint8], polarity: float | None = None, faint: bool = False) -> Silhouette | None:
    """The largest body by Otsu's threshold; None if there is none. polarity +1: the body is darker than its ground, -1
    lighter; None: the class that touches less of the picture's border. faint: set the threshold half way between the
    ground and the body's faint parts.

    A thin end lets light through, and a threshold half way to the whole body's grey would cut it off.
    """
    enlarge = ENLARGE if max(image.shape) * ENLARGE <= LONGEST_ENLARGED else 1
    fine = image if enlarge == 1 else cv2.resize(image, None, fx=enlarge, fy=enlarge, interpolation=cv2.INTER_CUBIC)
    fine = cv2.GaussianBlur(fine, (0, 0), 0.5 * enlarge)
    level, mask = cv2.threshold(fine, 0, 255, cv2.THRESH_BINARY_INV | cv2.THRESH_OTSU)
    low, high = np.percentile(fine, [1.0, 99.0])
    if not low < level < high:
        return None
    if polarity is None:
        border = np.concatenate([mask[0], mask[-1], mask[:, 0], mask[:, -1]])
        polarity = 1.0 if np.mean(border > 0) < 0.5 else -1.0
    if polarity < 0:
        mask = cv2.bitwise_not(mask)
    if faint:
        mask = _with_faint_parts(np.asarray(fine, dtype=np.float32), np.asarray(mask, dtype=np.uint8), polarity)
    contours, tree = cv2.findContours(mask, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    outer = [k for k in range(len(contours)) if tree[0][k][3] < 0]
    if not outer:
        return None
    areas = np.array([cv2.contourArea(contours[k]) for k in outer])
    largest = outer[int(np.argmax(areas))]
    holes = sum(cv2.contourArea(contours[k]) for k in range(len(contours)) if tree[0][k][3] == largest)
    if len(contours[largest]) < 20:
        return None
    # a contour runs through the centres of the mask's outermost pixels: half a fine pixel inside the edge
    placed = {k: (contours[k][:, 0].astype(float) + 0.5) / enlarge - 0.5 for k in outer}
    beside = tuple(
        placed[k] for k, area in zip(outer, areas, strict=True) if k != largest and area > SPECK * enlarge**2
    )
    return Silhouette(placed[largest], float(areas.max()) / enlarge**2, holes / enlarge**2, polarity, beside)


def _with_faint_parts(fine: NDArray[np.float32], mask: NDArray[np.uint8], polarity: float) -> NDArray[np.uint8]:
    """The mask of all pixels nearer to the grey of the body's faint parts than to the ground's; a first mask gives both
    greys.
    """
    shown = polarity * fine
    ground, weak = float(np.median(shown[mask == 0])), float(np.quantile(shown[mask > 0], FAINT_SHARE))
    return np.where(shown < 0.5 * (ground + weak), 255, 0).astype(np.uint8)


def find_ends(contour: Array) -> tuple[int, int]:
    """Indices of a slender body's two ends: where the contour turns most sharply, well apart along it."""
    even = _even_closed(contour, 400)
    window = max(int(END_WINDOW * len(even)), 2)
    ahead, behind = np.roll(even, -window, axis=0) - even, even - np.roll(even, window, axis=0)
    turn = np.arctan2(behind[:, 0] * ahead[:, 1] - behind[:, 1] * ahead[:, 0], np.sum(behind * ahead, axis=1))
    area = np.sum(even[:, 0] * np.roll(even[:, 1], -1) - even[:, 1] * np.roll(even[:, 0], -1))
    turn = turn * np.sign(area)
    turn = np.convolve(np.concatenate([turn[-3:], turn, turn[:3]]), np.ones(7) / 7.0, mode="valid")
    first = int(np.argmax(turn))
    apart = np.abs((np.arange(len(even)) - first + 200) % 400 - 200)
    second = int(np.argmax(np.where(apart > 100, turn, -np.inf)))
    nearest = [int(np.argmin(np.linalg.norm(contour - even[k], axis=1))) for k in (first, second)]
    return nearest[0], nearest[1]


def mean_axis(contour: Array, first: int, second: int, points: int = 100) -> Axis:
    """The mean of the perimeter's two sides from one end to the other: first by equal arcs, then along the axis'
    normals.
    """
    count = len(contour)
    forward = contour[np.arange(first, first + (second - first) % count + 1) % count]
    backward = contour[np.arange(first, first - (first - second) % count - 1, -1) % count]
    sides = [_even_open(_smooth(side), SIDE_POINTS) for side in (forward, backward)]
    axis = _even_open(0.5 * (sides[0] + sides[1]), points)
    width = np.linalg.norm(sides[0] - sides[1], axis=1)
    for _ in range(3):
        axis, width = _recentre(axis, sides)
        axis = _even_open(axis, points)
    length = float(np.sum(np.linalg.norm(np.diff(axis, axis=0), axis=1)))
    return Axis(axis, width, length)


def _recentre(axis: Array, sides: list[Array]) -> tuple[Array, Array]:
    """Move each inner point to the middle between the sides' points nearest to its normal."""
    tangent = np.gradient(axis, axis=0)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-9)
    step = np.linalg.norm(np.diff(sides[0], axis=0), axis=1).mean()
    place = np.linspace(0.0, 1.0, len(axis))
    found = []
    for side in sides:
        along = np.linspace(0.0, 1.0, len(side))
        offset = side[None] - axis[:, None]
        ahead = np.abs(np.einsum("psk,pk->ps", offset, tangent))
        far = np.linalg.norm(offset, axis=2)
        cost = np.where(np.abs(along[None] - place[:, None]) < 0.12, ahead + 0.02 * far, np.inf)
        best = np.argmin(cost, axis=1)
        shift = np.einsum("pk,pk->p", side[best] - axis, tangent)
        # move along the side to the normal itself
        heading = np.gradient(side, axis=0)[best] / max(step, 1e-9)
        rate = np.einsum("pk,pk->p", heading, tangent)
        slide = np.where(np.abs(rate) > 0.3, -shift / np.where(np.abs(rate) > 0.3, rate, 1.0), 0.0)
        found.append(side[best] + heading * np.clip(slide, -2 * step, 2 * step)[:, None])
    centre = 0.5 * (found[0] + found[1])
    centre[0], centre[-1] = axis[0], axis[-1]
    kernel = np.array([1.0, 2.0, 3.0, 2.0, 1.0]) / 9.0
    inner = np.stack([np.convolve(centre[:, k], kernel, mode="valid") for k in range(2)], axis=1)
    centre[2:-2] = inner
    return centre, np.linalg.norm(found[0] - found[1], axis=1)


def _smooth(side: Array) -> Array:
    kernel = np.ones(5) / 5.0
    padded = np.concatenate([np.repeat(side[:1], 2, axis=0), side, np.repeat(side[-1:], 2, axis=0)])
    return np.stack([np.convolve(padded[:, k], kernel, mode="valid") for k in range(2)], axis=1)


def _even_open(points: Array, count: int) -> Array:
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    even = np.linspace(0.0, arc[-1], count)
    return np.stack([np.interp(even, arc, points[:, k]) for k in range(2)], axis=1)


def _even_closed(points: Array, count: int) -> Array:
    return _even_open(np.concatenate([points, points[:1]]), count + 1)[:-1]
