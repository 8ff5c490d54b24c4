"""Where the picture's edges lie about the expected outline: searched for, fitted each by itself, or all together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tentacle.compiled import njit
from tentacle.signals import Array
from vision.kinematics import Outline
from vision.lens import Lens, bend_point
from vision.levels import count_strange, side_greys
from vision.light import Light
from vision.motion import Sweep
from vision.profiles import fit_profiles, gather, level_sums, measure_profiles, plateaus
from vision.robust import AROUND, PLAIN, neighbours_mean

LONGEST = 256  # samples that a searched profile may have
STRANGE = 4.0  # times the usual rms of a profile's residual
FEW = 0.05  # of the places: that noise alone may put in contradiction to the light
LEVEL_REACH = 4.0  # px beyond the blur from which the greys beside an edge are told; a mirror image is often near


@dataclass(frozen=True)
class Edges:
    """What the profiles say, one entry per edge of the outline.

    offset (E,) [px]: how far outward of the expected place the edge lies. level (E,): grey inside. contrast (E,):
    outside minus inside grey. information (E,): 1/px^2 per squared grey level of noise. misfit (E,): rms of the
    profile's residual [grey]. found (E,): a profile with both of its sides in the picture and an edge within reach.
    softer (E, 2): right and left side of each edge's normal equation for how much more blurred it is than expected
    [px]; 0 where not measured. plateaus (E, 2, 3): profiles.plateaus; no pixels where not measured.
    """

    offset: Array
    level: Array
    contrast: Array
    information: Array
    misfit: Array
    found: NDArray[np.bool_]
    softer: Array
    plateaus: Array


def search_edges(image: NDArray[np.uint8], expected: Outline, lens: Lens, reach: float, polarity: float) -> Edges:
    """The strongest step, to a pixel, along each edge's normal, from anywhere within reach [px].

    polarity is +1 for an arm darker than its ground, -1 for a lighter one.
    """
    count = len(expected.points)
    offset, contrast, found = np.zeros(count), np.zeros(count), np.zeros(count, dtype=np.bool_)
    place = (image, lens.packed, expected.points, expected.normals, expected.depth)
    _search(*place, float(reach), float(polarity), offset, contrast, found)
    return Edges(
        offset,
        np.zeros(count),
        contrast,
        np.ones(count),
        np.zeros(count),
        found,
        *_not_measured(count),
    )


def fit_edges(
    image: NDArray[np.uint8],
    expected: Outline,
    lens: Lens,
    reach: float,
    polarity: float,
    blur: float,
    swept: Sweep,
) -> Edges:
    """Each edge to a part of a pixel with its own greys; right where it is within about 2 px of its place.

    blur [px] is the lens' and the pixel's; swept tells how the edges move while the shutter is open.
    """
    count = len(expected.points)
    half = 0.5 * swept.width
    offset, contrast, information, misfit, level = (np.zeros(count) for _ in range(5))
    found = np.zeros(count, dtype=np.bool_)
    pixels = _pixels(image, expected, lens, blur, half, reach)
    out = (offset, contrast, information, misfit, level, found)
    fit_profiles(*pixels, expected.depth, blur, half, reach, *out)
    found &= polarity * contrast > 0
    return Edges(
        offset + _inward(expected, blur) - swept.shift,
        level,
        contrast,
        information,
        misfit,
        found,
        *_not_measured(count),
    )


def measure_edges(
    image: NDArray[np.uint8],
    expected: Outline,
    lens: Lens,
    reach: float,
    polarity: float,
    blur: float,
    swept: Sweep,
    alone: Edges,
    sound: NDArray[np.bool_],
    light: Light | None,
) -> Edges:
    """Each edge about a place that is right to a small part of the blur, its greys from its neighbours' pixels.

    alone: the same edges, fitted each by itself; sound (E,): those of them that tell the greys. light: what earlier
    pictures told of them.
    """
    count = len(expected.points)
    half = 0.5 * swept.width
    offset, information, misfit = (np.zeros(count) for _ in range(3))
    found, softer = np.zeros(count, dtype=np.bool_), np.zeros((count, 2))
    inside = float(np.median(alone.level[sound])) if sound.any() else 0.0
    ratio = inside / max(inside + float(np.median(alone.contrast[sound])), 1.0) if sound.any() else 1.0
    pixels = _pixels(image, expected, lens, blur, half, LEVEL_REACH)
    tell = sound & ~_beside_something(pixels, expected, blur, half, alone, sound)
    lit, known = np.zeros((count, 4)), np.zeros(count, dtype=np.bool_)
    if light is not None:
        lit, known = light.beside(expected.points, expected.normals, lens)
    profile = (*pixels, expected.depth, blur, half)
    sums = level_sums(*profile, ratio, np.zeros((count, 2)))
    beside = (expected.kind, tell, sums, ratio, lit, known)
    greys, known, contradicted = side_greys(*beside, np.zeros((0, 16)))
    if contradicted > FEW:
        outside = level_sums(*profile, 0.0, np.ascontiguousarray(lit[:, ::3]))
        greys, known, _ = side_greys(*beside, outside)
    contrast = greys[:, 1] - greys[:, 0]
    measure_profiles(*profile, greys, reach, offset, information, misfit, found, softer)
    found &= known & (polarity * contrast > 0)
    return Edges(
        offset + _inward(expected, blur) - swept.shift,
        greys[:, 0],
        contrast,
        information,
        misfit,
        found,
        softer,
        plateaus(*profile, contrast, tell & known),
    )


def _beside_something(
    pixels: tuple[NDArray[np.int64], Array, Array],
    expected: Outline,
    blur: float,
    half: Array,
    alone: Edges,
    sound: NDArray[np.bool_],
) -> NDArray[np.bool_]:
    """Edges (E,) that are sound, but with a bubble close by: within the pixels that would tell the greys."""
    if not sound.any():
        return ~sound
    weight = sound.astype(float)
    inside, told = neighbours_mean(expected.kind, alone.level, weight, AROUND)
    contrast, _ = neighbours_mean(expected.kind, alone.contrast, weight, AROUND)
    usual = max(float(np.median(alone.misfit[sound])), PLAIN * float(np.median(np.abs(alone.contrast[sound]))))
    return (told > 0.5) & (count_strange(*pixels, blur, half, inside, inside + contrast, STRANGE * usual) > 1)


def _not_measured(count: int) -> tuple[Array, Array]:
    """softer and plateaus of edges that are only searched for, or fitted each by itself."""
    return np.zeros((count, 2)), np.zeros((count, 2, 3))


def _inward(expected: Outline, blur: float) -> Array:
    """What blur takes from a bulging edge (E,) [px]: its half-way grey lies further in."""
    return 0.5 * expected.bulge * blur**2


def _pixels(image: NDArray[np.uint8], expected: Outline, lens: Lens, blur: float, half: Array, reach: float):
    outline = (expected.points, expected.normals, expected.depth, expected.span, expected.bulge)
    return gather(image, lens.packed, *outline, float(blur), half, float(reach))


@njit(cache=True, inline="always")
def _grey(image: NDArray[np.uint8], u: float, v: float) -> float:
    """Bilinear sample; NaN outside the picture."""
    height, width = image.shape
    if not (u >= 0.0 and v >= 0.0 and u < width - 1 and v < height - 1):
        return np.nan
    column, row = int(u), int(v)
    du, dv = u - column, v - row
    top = image[row, column] * (1.0 - du) + image[row, column + 1] * du
    bottom = image[row + 1, column] * (1.0 - du) + image[row + 1, column + 1] * du
    return top * (1.0 - dv) + bottom * dv


@njit(cache=True, nogil=True)
def _search(
    image: NDArray[np.uint8],
    lens: Array,
    points: Array,
    normals: Array,
    depth: Array,
    reach: float,
    polarity: float,
    offset: Array,
    contrast: Array,
    found: NDArray[np.bool_],
) -> None:
    """The strongest step of the right sign along each profile; a nearer one is preferred among equals."""
    grey = np.empty(LONGEST)
    for e in range(points.shape[0]):
        found[e] = False
        half = 2 if depth[e] > 4.0 else 1
        start = -int(reach) - half
        count = min(2 * int(reach) + 2 * half + 1, LONGEST)
        best = 0.0
        for k in range(count):
            d = float(start + k)
            u, v = bend_point(points[e, 0] + d * normals[e, 0], points[e, 1] + d * normals[e, 1], lens)
            grey[k] = _grey(image, u, v)
        for k in range(half, count - half):
            step = 0.0
            for j in range(1, half + 1):
                step += grey[k + j] - grey[k - j]
            step /= half
            if np.isnan(step):
                continue
            d = float(start + k)
            value = polarity * step * (1.0 - 0.4 * (d / (reach + 1.0)) ** 2)
            if value > best:
                best, offset[e], contrast[e], found[e] = value, d, step, True


@njit(cache=True, nogil=True)
def grey_at(image: NDArray[np.uint8], lens: Array, points: Array) -> Array:
    """Bilinear grey levels (N,) at points (N, 2) of the ideal picture; NaN outside."""
    values = np.empty(points.shape[0])
    for k in range(points.shape[0]):
        u, v = bend_point(points[k, 0], points[k, 1], lens)
        values[k] = _grey(image, u, v)
    return values
