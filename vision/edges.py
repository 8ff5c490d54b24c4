"""Edges in the picture near the expected outline: searched, fitted one by one, or fitted together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tentacle.compiled import njit
from tentacle.signals import Array
from vision.greys_beside import BEYOND, level_sums, plateaus
from vision.kinematics import Outline
from vision.lens import Lens, bend_point
from vision.levels import KnownLight, count_strange, side_greys
from vision.light import Light
from vision.motion import Sweep
from vision.profiles import Bars, Pixels, Stations, fit_profiles, gather, measure_profiles
from vision.robust import AROUND, PLAIN, neighbours_mean

LONGEST_PROFILE = 256  # samples that a searched profile may have
STRANGE_EDGE = 4.0  # times the usual rms of a profile's residual
FEW = 0.05  # share of the places that noise alone may bring into contradiction with the light
LEVEL_REACH = 4.0  # px beyond the blur that give the greys beside an edge; a mirror image is often near


@dataclass(frozen=True)
class Edges:
    """Results of the profiles, one entry per edge of the outline.

    offset (E,) [px]: distance of the edge outward from the expected place. level (E,): grey inside. contrast (E,):
    outside minus inside grey. information (E,): 1/px^2 per squared grey level of noise. misfit (E,): rms of the
    profile's residual [grey]. found (E,): a profile with both sides in the picture and an edge within reach. softer (E,
    2): right and left side of each edge's normal equation for the additional blur [px]; 0 if not measured. plateaus (E,
    2, 3): profiles.plateaus; no pixels where not measured.
    """

    offset: Array
    level: Array
    contrast: Array
    information: Array
    misfit: Array
    found: NDArray[np.bool_]
    softer: Array
    plateaus: Array


@dataclass(frozen=True)
class Optics:
    """The optics of edges: the lens, the blur [px] of lens and pixel, polarity (+1 for an arm darker than its
    ground, -1 for a lighter one)."""

    lens: Lens
    blur: float
    polarity: float


@dataclass(frozen=True)
class Before:
    """Earlier results about the edges: alone, each fitted by itself; sound (E,), those usable for the greys; light, the
    greys from earlier pictures; fade (E,), EdgeLook.fade_at.
    """

    alone: Edges
    sound: NDArray[np.bool_]
    light: Light | None
    fade: Array


def search_edges(image: NDArray[np.uint8], expected: Outline, lens: Lens, reach: float, polarity: float) -> Edges:
    """The strongest step, to a pixel, along each edge's normal, from anywhere within reach [px].

    polarity is +1 for an arm darker than its ground, -1 for a lighter one.
    """
    count = len(expected.points)
    lines = (expected.points, expected.normals, expected.depth)
    offset, contrast, found = _search(image, lens.packed, lines, float(reach), float(polarity))
    return Edges(
        offset,
        np.zeros(count),
        contrast,
        np.ones(count),
        np.zeros(count),
        found,
        *_not_measured(count),
    )


def fit_edges(image: NDArray[np.uint8], expected: Outline, optics: Optics, reach: float, swept: Sweep) -> Edges:
    """Fit each edge with its own greys, to a fraction of a pixel; valid for edges within about 2 px of their expected
    place. swept: motion of the edges while the shutter is open.
    """
    bars = Bars(expected.depth, optics.blur, 0.5 * swept.width)
    fitted = fit_profiles(_pixels(image, expected, optics.lens, bars, reach), bars, float(reach))
    return Edges(
        fitted.offset + _inward(expected, optics.blur) - swept.shift,
        fitted.level,
        fitted.contrast,
        fitted.information,
        fitted.misfit,
        fitted.found & (optics.polarity * fitted.contrast > 0),
        *_not_measured(len(expected.points)),
    )


def measure_edges(
    image: NDArray[np.uint8],
    expected: Outline,
    optics: Optics,
    reach: float,
    swept: Sweep,
    before: Before,
) -> Edges:
    """Fit each edge about a place with an error of a small part of the blur, with the greys from its neighbours'
    pixels.
    """
    count = len(expected.points)
    alone, sound, light = before.alone, before.sound, before.light
    bars = Bars(expected.depth, optics.blur, 0.5 * swept.width)
    inside = float(np.median(alone.level[sound])) if sound.any() else 0.0
    ratio = inside / max(inside + float(np.median(alone.contrast[sound])), 1.0) if sound.any() else 1.0
    pixels = _pixels(image, expected, optics.lens, bars, LEVEL_REACH)
    tell = sound & ~_beside_something(pixels, bars, expected, alone, sound)
    lit = KnownLight(np.zeros((count, 4)), np.zeros(count, dtype=np.bool_))
    if light is not None:
        lit = KnownLight(*light.beside(expected.points, expected.normals, optics.lens))
        lit.greys[:, 0] = lit.greys[:, 1] - (lit.greys[:, 1] - lit.greys[:, 0]) / before.fade
    sums = level_sums(pixels, bars, ratio, np.zeros((count, 2)), before.fade)
    beside = (expected.kind, tell, sums, ratio, lit)
    greys, known, contradicted = side_greys(*beside, np.zeros((0, 16)))
    if contradicted > FEW:
        outside = level_sums(pixels, bars, 0.0, np.ascontiguousarray(lit.greys[:, ::3]), before.fade)
        greys, known, _ = side_greys(*beside, outside)
    greys[:, 0] = _one_grey(expected, greys[:, 0], known & ~lit.known, optics.blur)
    greys[:, 0] = greys[:, 1] - before.fade * (greys[:, 1] - greys[:, 0])
    contrast = greys[:, 1] - greys[:, 0]
    measured = measure_profiles(pixels, bars, greys, float(reach))
    return Edges(
        measured.offset + _inward(expected, optics.blur) - swept.shift,
        greys[:, 0],
        contrast,
        measured.information,
        measured.misfit,
        measured.found & known & (optics.polarity * contrast > 0),
        measured.softer,
        plateaus(pixels, bars, contrast, tell & known),
    )


def _one_grey(expected: Outline, inside: Array, free: NDArray[np.bool_], blur: float) -> Array:
    """Grey inside (E,) with one value for both sides of a thin body, where it comes from this picture alone.

    No pixel of a thin body is free of both edges' blur. Each side alone then tells the grey so badly that the two
    values differ by noise, which moves both edges the same way, and so the midline, over whole stretches.
    """
    left, right = np.flatnonzero(expected.kind == 0), np.flatnonzero(expected.kind == 1)
    tied = free[left] & free[right] & (expected.depth[left] < 2.0 * BEYOND * blur)
    inside = inside.copy()
    inside[left[tied]] = inside[right[tied]] = 0.5 * (inside[left[tied]] + inside[right[tied]])
    return inside


def _beside_something(
    pixels: Pixels, bars: Bars, expected: Outline, alone: Edges, sound: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Sound edges (E,) with a bubble among the pixels that would give their greys."""
    if not sound.any():
        return ~sound
    weight = sound.astype(float)
    inside, told = neighbours_mean(expected.kind, alone.level, weight, AROUND)
    contrast, _ = neighbours_mean(expected.kind, alone.contrast, weight, AROUND)
    usual = max(float(np.median(alone.misfit[sound])), PLAIN * float(np.median(np.abs(alone.contrast[sound]))))
    return (told > 0.5) & (count_strange(pixels, bars, inside, inside + contrast, STRANGE_EDGE * usual) > 1)


def _not_measured(count: int) -> tuple[Array, Array]:
    """Empty softer and plateaus, for edges that are only searched or fitted one by one."""
    return np.zeros((count, 2)), np.zeros((count, 2, 3))


def _inward(expected: Outline, blur: float) -> Array:
    """Shift [px] (E,) of a convex edge by the blur: its half-way grey lies further inside."""
    return 0.5 * expected.bulge * blur**2


def _pixels(image: NDArray[np.uint8], expected: Outline, lens: Lens, bars: Bars, reach: float) -> Pixels:
    stations = Stations(expected.points, expected.normals, expected.span, expected.bulge)
    return gather(image, lens.packed, stations, bars, float(reach))


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
    image: NDArray[np.uint8], lens: Array, lines: tuple[Array, Array, Array], reach: float, polarity: float
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """The strongest step of the right sign along each profile: offset, contrast, whether there is one (E,).

    A nearer step is preferred among equals. lines: points, normals (E, 2) and depth (E,).
    """
    points, normals, depth = lines
    count_of_edges = points.shape[0]
    offset, contrast = np.zeros(count_of_edges), np.zeros(count_of_edges)
    found = np.zeros(count_of_edges, dtype=np.bool_)
    grey = np.empty(LONGEST_PROFILE)
    for e in range(points.shape[0]):
        found[e] = False
        half = 2 if depth[e] > 4.0 else 1
        start = -int(reach) - half
        count = min(2 * int(reach) + 2 * half + 1, LONGEST_PROFILE)
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
    return offset, contrast, found


@njit(cache=True, nogil=True)
def grey_at(image: NDArray[np.uint8], lens: Array, points: Array) -> Array:
    """Bilinear grey levels (N,) at points (N, 2) of the ideal picture; NaN outside."""
    values = np.empty(points.shape[0])
    for k in range(points.shape[0]):
        u, v = bend_point(points[k, 0], points[k, 1], lens)
        values[k] = _grey(image, u, v)
    return values
