"""The bodies in pictures of one film that can be the arm: one contour a picture.

The arm is slender, has contrast with its smooth ground, moves, and is held: one of its ends is at the same place in all
pictures. So each picture gives all its slender bodies, and the place where the best of them begin chooses among these.
What passes in front (a post, a glare) cuts a body in two; two bodies that continue each other's course are joined.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations

import cv2
import numpy as np
from numpy.typing import NDArray

from tentacle.signals import Array
from vision.body_axis import LEAST_SLENDERNESS, axis_between
from vision.frames import Grey
from vision.silhouette import Axis, find_ends

FINE_BELOW = 480  # px; smaller pictures are enlarged
STANDING_OUT = 5.0  # least contrast, in units of the ground's scatter
HALF_WAY, CONTRAST = 0.45, 0.8  # of the arm's contrast, which is this quantile of the foreground's, by its own weight
NEAR = 4  # px of a picture of FINE_BELOW: a threshold is that share of the largest contrast so near
SHORTEST_ARM = 20.0  # px of length
STILL, ALWAYS = 0.1, 0.9  # weight of a body that does not move; the share of the pictures in which it is found
LEAST_PICTURES = 5  # that tell the ground's own dirt
SELDOM = 0.25  # the arm is elsewhere in more than that share of them
GAP = 0.6  # of the longer part: widest gap between two parts of one body
TURN = 0.7  # rad by which the course may turn on either side of the gap
BEFORE, AT = 0.6, 0.85  # of a part: stretch that gives its course and its width towards a gap; the cut may be oblique
STRIP = 0.3  # of its area, by which an axis' length times mean width may be off: two bodies that cross are no strip
ALIKE = 2.0  # times: largest ratio of the widths on both sides
MOST_CANDIDATES = 3  # sets of bodies of one polarity
NEAR_BASE = 0.2  # of its length: how far a body's axis may be from a known base; a holder may hide its begin


@dataclass(frozen=True)
class SlenderBody:
    """A slender body: its mask on the enlarged picture, contour (C, 2) [px], mean axis, and how like an arm it is."""

    mask: NDArray[np.bool_]
    contour: Array
    axis: Axis
    merit: float


def candidate_bodies(
    pictures: Sequence[Grey], polarity: float, base: Array | None = None
) -> list[list[SlenderBody | None]]:
    """Sets of bodies that may be the arm, the likeliest first: in each picture a slender body that is held at one
    place, or None. polarity +1: darker than the ground, -1: lighter. base (2,) [px]: a known place, then one set.
    """
    contrasts = _contrasts(pictures, polarity)
    masks = [_mask(contrast) for contrast in contrasts]
    always = np.mean(masks, axis=0) > ALWAYS if len(masks) > 3 else np.zeros(masks[0].shape, dtype=bool)
    seen = [_bodies(mask, contrast, always) for mask, contrast in zip(masks, contrasts, strict=True)]
    if base is not None:
        return [[_best_through(bodies, base) for bodies in seen]]
    found: list[list[SlenderBody | None]] = []
    while len(found) < MOST_CANDIDATES and (place := _held(seen)) is not None:
        found.append([_best_at(bodies, place) for bodies in seen])
        seen = [_beside(bodies, taken) for bodies, taken in zip(seen, found[-1], strict=True)]
    return found


def _contrasts(pictures: Sequence[Grey], polarity: float) -> list[NDArray[np.float32]]:
    """Contrast (H, W) [grey] with the smooth ground, without the dirt that is there without the arm."""
    apart = []
    for image in pictures:
        shrink = max(max(image.shape) // 160, 1)
        small = cv2.resize(image, None, fx=1.0 / shrink, fy=1.0 / shrink, interpolation=cv2.INTER_AREA)
        wide = min(51, 2 * (min(small.shape) // 3) + 1)
        ground = cv2.resize(cv2.medianBlur(small, wide), image.shape[::-1], interpolation=cv2.INTER_LINEAR)
        smooth = cv2.GaussianBlur(image, (0, 0), 0.8)
        apart.append(np.asarray(polarity * (ground.astype(np.float32) - smooth.astype(np.float32)), dtype=np.float32))
    if len(apart) < LEAST_PICTURES:
        return apart
    still = np.asarray(np.quantile(apart, SELDOM, axis=0), dtype=np.float32)
    bare = _nearby(still) < max(_level(picture, _noise(picture)) for picture in apart)
    return [np.asarray(picture - np.where(bare, still, 0.0), dtype=np.float32) for picture in apart]


def _noise(contrast: NDArray[np.float32]) -> float:
    """The least contrast that stands out, from the median absolute deviation of a part of the pixels."""
    every = max(max(contrast.shape) // FINE_BELOW, 1)
    some = contrast[::every, ::every]
    scatter = np.median(np.abs(some - np.median(some)))
    return STANDING_OUT * (1.4826 * float(scatter) + 0.3)


def _level(contrast: NDArray[np.float32], noise: float) -> float:
    """Half way to the contrast of what stands out; strong contrast counts more, because a codec leaves much faint."""
    out = np.sort(contrast[contrast > noise])
    if not out.size:
        return float(np.inf)
    usual = out[int(np.searchsorted(np.cumsum(out), CONTRAST * float(out.sum())))]
    return max(noise, HALF_WAY * float(usual))


def _mask(contrast: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Mask of the foreground, enlarged where the picture is small: parts half way to the contrast nearby, so that a
    tip that lets light through is in it (Bernsen 1986), of bodies that somewhere stand out as much as the arm.
    """
    grow, noise = enlarged(contrast.shape), _noise(contrast)
    threshold = np.maximum(noise, HALF_WAY * _nearby(contrast))
    fine = contrast
    if grow > 1:
        fine = cv2.resize(contrast, None, fx=grow, fy=grow, interpolation=cv2.INTER_CUBIC)
        threshold = cv2.resize(threshold, None, fx=grow, fy=grow, interpolation=cv2.INTER_LINEAR)
    _, part = cv2.connectedComponents((fine > threshold).astype(np.uint8))
    strong = np.unique(part[(fine > _level(contrast, noise)) & (part > 0)])
    return np.isin(part, strong[strong > 0])


def _nearby(contrast: NDArray[np.float32]) -> NDArray[np.float32]:
    """The largest contrast (H, W) near each pixel."""
    wide = max(round(NEAR * max(contrast.shape) / FINE_BELOW), NEAR)
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * wide + 1, 2 * wide + 1))
    return np.asarray(cv2.dilate(contrast, disc), dtype=np.float32)


def enlarged(shape: Sequence[int]) -> int:
    """Fine pixels of a mask to a side of a picture's pixel."""
    return 4 if max(shape) < FINE_BELOW else 1


def _bodies(mask: NDArray[np.bool_], contrast: NDArray[np.float32], always: NDArray[np.bool_]) -> list[SlenderBody]:
    """All slender bodies of a mask, and those of two parts on both sides of something in front."""
    grow = enlarged(contrast.shape)
    contours, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    masks = []
    for contour in contours:
        if 0.5 * cv2.arcLength(contour, True) >= 0.25 * SHORTEST_ARM * grow:
            filled = np.zeros(mask.shape, np.uint8)
            cv2.fillPoly(filled, [contour], 1)
            masks.append(filled > 0)
    alone = [body for one in masks if (body := _body(one, contrast, always)) is not None]
    joined = [_bridged(one, other, grow) for one, other in permutations(alone, 2) if _continues(one, other)]
    whole = [body for one in joined if (body := _body(one, contrast, always)) is not None]
    return [body for body in (*alone, *whole) if body.axis.length >= SHORTEST_ARM]


def _body(mask: NDArray[np.bool_], contrast: NDArray[np.float32], always: NDArray[np.bool_]) -> SlenderBody | None:
    """The body of a mask without holes; None if it is not slender. Its merit: length, motion and contrast."""
    grow = enlarged(contrast.shape)
    contours, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    contour = max(contours, key=cv2.contourArea)
    area, length = cv2.contourArea(contour), 0.5 * cv2.arcLength(contour, True)
    if len(contour) < 20 or length**2 < LEAST_SLENDERNESS * max(area, 1.0):
        return None
    points = (contour[:, 0].astype(float) + 0.5) / grow - 0.5
    axis = axis_between(points, *find_ends(points))
    if axis is None or not abs(axis.length * float(np.mean(axis.width)) * grow**2 / area - 1.0) < STRIP:
        return None
    coarse = mask if grow == 1 else cv2.resize(mask.astype(np.uint8), contrast.shape[::-1]) > 0
    strength = float(np.mean(contrast[coarse])) if coarse.any() else 0.0
    moving = STILL + np.count_nonzero(mask & ~always) / max(np.count_nonzero(mask), 1)
    return SlenderBody(mask, points, axis, float(axis.length * moving * max(strength, 0.0)))


def _end(axis: Axis) -> tuple[Array, Array, float]:
    """A part's last point, its course (2,) there, and its width before."""
    count = len(axis.points)
    course = axis.points[int(AT * count)] - axis.points[int(BEFORE * count)]
    wide = axis.width[int(BEFORE * len(axis.width)) : int(AT * len(axis.width))]
    return axis.points[-1], course / max(float(np.linalg.norm(course)), 1e-9), float(np.median(wide))


def _facing(one: SlenderBody, other: SlenderBody) -> tuple[Axis, Axis]:
    """Both axes, turned so that each ends at the gap between them."""
    ways = [(a, b) for a in (one.axis, reversed_axis(one.axis)) for b in (other.axis, reversed_axis(other.axis))]
    return min(ways, key=lambda way: float(np.linalg.norm(way[0].points[-1] - way[1].points[-1])))


def _continues(one: SlenderBody, other: SlenderBody) -> bool:
    """Whether the second body goes on where the first one ends, beyond a gap."""
    first, second = _facing(one, other)
    (at, ahead, wide), (beyond, back, narrow) = _end(first), _end(second)
    gap = beyond - at
    far = float(np.linalg.norm(gap))
    longer = max(first.length, second.length)
    straight = min(float(ahead @ gap), -float(back @ gap)) > np.cos(TURN) * far
    return first.length >= second.length and far < GAP * longer and straight and 1.0 / ALIKE < narrow / wide < ALIKE


def _bridged(one: SlenderBody, other: SlenderBody, grow: int) -> NDArray[np.bool_]:
    """The mask of both, with the gap between them filled."""
    first, second = _facing(one, other)
    corners = []
    for axis in (first, second):
        point, (_, course, wide) = axis.points[int(AT * len(axis.points))], _end(axis)
        along = course * (1.0 if axis is first else -1.0)
        across = 0.5 * wide * np.array([-along[1], along[0]])
        corners.append((point + across, point - across))
    (a, b), (c, d) = corners
    filled = (one.mask | other.mask).astype(np.uint8)
    cv2.fillPoly(filled, [np.rint((np.array([a, c, d, b]) + 0.5) * grow - 0.5).astype(np.int32)], 1)
    return filled > 0


def reversed_axis(axis: Axis) -> Axis:
    """The same axis from its other end."""
    return Axis(axis.points[::-1], axis.width[::-1], axis.length)


def _apart(body: SlenderBody, place: Array) -> float:
    """Distance of a body's nearer end from a place, over its largest width: a flat end is seen at either corner."""
    ends = body.axis.points[[0, -1]]
    return float(np.linalg.norm(ends - place, axis=1).min()) / max(float(body.axis.width.max()), 1.0)


def _held(seen: Sequence[Sequence[SlenderBody]]) -> Array | None:
    """The place (2,) at which the best bodies of all pictures have an end."""
    places = [end for bodies in seen for body in bodies for end in body.axis.points[[0, -1]]]
    if not places:
        return None
    worth = [sum(body.merit for bodies in seen if (body := _best_at(bodies, place)) is not None) for place in places]
    return places[int(np.argmax(worth))]


def _beside(bodies: Sequence[SlenderBody], taken: SlenderBody | None) -> list[SlenderBody]:
    """The bodies beside one that is taken, without a common pixel; none if the picture does not show it."""
    return [body for body in bodies if taken is not None and not np.any(body.mask & taken.mask)]


def _best_through(bodies: Sequence[SlenderBody], base: Array) -> SlenderBody | None:
    """The best body whose axis passes near a known base."""
    near = [body for body in bodies if _off_axis(body, base) < NEAR_BASE * body.axis.length]
    return max(near, key=lambda body: body.merit, default=None)


def _off_axis(body: SlenderBody, place: Array) -> float:
    """Distance [px] of a body's axis from a place."""
    return float(np.linalg.norm(body.axis.points - place, axis=1).min())


def _best_at(bodies: Sequence[SlenderBody], place: Array | None) -> SlenderBody | None:
    """The best body that has an end at the place."""
    there = [body for body in bodies if place is not None and _apart(body, place) < 1.0]
    return max(there, key=lambda body: body.merit, default=None)
