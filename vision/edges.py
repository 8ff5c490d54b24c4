"""Edge profiles across the expected outline: local grey inside and outside, and where between them the edge lies."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from tentacle.signals import Array
from vision.kinematics import Outline
from vision.lens import Lens, bend_point

LONGEST = 256  # samples that a profile may have
GROUND = 6  # samples of the ground, 1 px apart, that tell its slope


@dataclass(frozen=True)
class Edges:
    """What the profiles say, one entry per edge of the outline.

    offset (E,) [px]: how far outward of the expected place the edge lies. contrast (E,): outside minus inside grey.
    information (E,): 1/px^2 per squared grey level of noise. misfit (E,): rms of the profile's residual [grey]. slope
    (E,) [grey/px]: how the ground's grey changes outward. level (E,): grey inside. found (E,): a profile with both of
    its sides in the picture and an edge within reach.
    """

    offset: Array
    contrast: Array
    information: Array
    misfit: Array
    slope: Array
    level: Array
    found: NDArray[np.bool_]


@dataclass(frozen=True)
class Surroundings:
    """The greys beside each edge (E,), as its neighbours show them: level inside, contrast, slope of the ground."""

    level: Array
    contrast: Array
    slope: Array


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


@njit(cache=True, inline="always")
def _below(x: float) -> float:
    """The normal distribution function."""
    return 0.5 * math.erfc(-x * 0.7071067811865476)


@njit(cache=True, inline="always")
def _bell(x: float) -> float:
    """The normal density."""
    return 0.3989422804014327 * math.exp(-0.5 * x * x)


@njit(cache=True, inline="always")
def _rise(d: float, blur: float, half: float) -> float:
    """A step from 0 to 1 at d = 0, through a normal blur and a box of half width half: the smear of a moving edge."""
    if half < 0.15 * blur:
        return _below(d / blur)
    a, b = (d + half) / blur, (d - half) / blur
    return (a * _below(a) + _bell(a) - b * _below(b) - _bell(b)) * blur / (2.0 * half)


@njit(cache=True, inline="always")
def _steepness(d: float, blur: float, half: float) -> float:
    """The derivative of _rise by d."""
    if half < 0.15 * blur:
        return _bell(d / blur) / blur
    return (_below((d + half) / blur) - _below((d - half) / blur)) / (2.0 * half)


@njit(cache=True, nogil=True)
def _sharp(
    image: NDArray[np.uint8],
    lens: Array,
    points: Array,
    normals: Array,
    depth: Array,
    blur: float,
    half: Array,
    ground: Array,
    inside_level: Array,
    step: Array,
    known: bool,
    reach: float,
    offset: Array,
    contrast: Array,
    information: Array,
    misfit: Array,
    slope: Array,
    level: Array,
    found: NDArray[np.bool_],
) -> None:
    """Fit outside level, contrast and offset of a blurred bar's edge to each profile, by Gauss-Newton."""
    height, width = image.shape
    grey, place, share = np.empty(LONGEST), np.empty(LONGEST), np.empty(LONGEST)
    for e in range(points.shape[0]):
        found[e] = False
        fuzzy = 2.0 * blur + half[e]
        outer = math.ceil(reach + fuzzy)
        inner = math.ceil(min(reach + fuzzy, max(0.5 * depth[e], 1.0)))
        thin = depth[e] < 2.0 * fuzzy + 2.0
        count = 0
        inside = True
        last_column, last_row = -1, -1
        for k in range(-inner, outer + 1):
            # a whole pixel at its true distance: interpolation would add errors that go with the pixels' phase
            u, v = bend_point(points[e, 0] + k * normals[e, 0], points[e, 1] + k * normals[e, 1], lens)
            column, row = round(u), round(v)
            if not (0 <= column < width and 0 <= row < height):
                inside = False
                break
            if (column == last_column and row == last_row) or count == LONGEST:
                continue
            grey[count] = image[row, column]
            place[count] = k + (column - u) * normals[e, 0] + (row - v) * normals[e, 1]
            last_column, last_row, count = column, row, count + 1
        if not inside:
            continue
        delta, contrast_here, grey_here = 0.0, step[e], inside_level[e]
        total, solved = 0.0, False
        for sweep in range(3):  # linear in (level, step); one Newton step in delta follows each solve
            n_c, n_cc, n_y, n_yc = 0.0, 0.0, 0.0, 0.0
            for k in range(count):
                d = place[k] - delta
                c = _rise(d, blur, half[e])  # share of outside
                if thin:  # the bar's other edge is near
                    c += _rise(-d - depth[e], blur, half[e])
                share[k] = c
                y = grey[k] - ground[e] * place[k] * c
                n_c += c
                n_cc += c * c
                n_y += y
                n_yc += y * c
            spread = n_cc - n_c * n_c / count
            if not known:
                if spread < 1e-3:
                    break
                contrast_here = (n_yc - n_y * n_c / count) / spread
                grey_here = (n_y - contrast_here * n_c) / count
            if contrast_here == 0.0:
                break
            # derivative by delta, with level and step projected out where they are fitted (variable projection)
            g_sum, g_c, g_g, r_g, total = 0.0, 0.0, 0.0, 0.0, 0.0
            for k in range(count):
                c = share[k]
                g = -contrast_here * _steepness(place[k] - delta, blur, half[e])
                residual = grey[k] - ground[e] * place[k] * c - grey_here - contrast_here * c
                g_sum += g
                g_c += g * c
                g_g += g * g
                r_g += residual * g
                total += residual * residual
            fisher = g_g if known else g_g - g_sum * g_sum / count - (g_c - g_sum * n_c / count) ** 2 / spread
            if fisher <= 1e-9:
                break
            solved = True
            if sweep < 2:
                delta += min(max(r_g / fisher, -1.0), 1.0)
            information[e] = fisher
        offset[e], contrast[e], level[e] = delta, contrast_here, grey_here
        misfit[e] = math.sqrt(total / count)
        # the ground's slope from what lies beyond the blur, which a wrong blur cannot bend
        rise, seen = 0.0, True
        for k in range(GROUND):
            d = delta + math.ceil(2.6 * blur + half[e]) + k
            u, v = bend_point(points[e, 0] + d * normals[e, 0], points[e, 1] + d * normals[e, 1], lens)
            value = _grey(image, u, v)
            seen = seen and not np.isnan(value)
            rise += value * (k - 0.5 * (GROUND - 1))
        slope[e] = rise * 12.0 / (GROUND * (GROUND**2 - 1)) if seen else 0.0
        found[e] = solved and abs(delta) <= reach


@njit(cache=True, nogil=True)
def _wide(
    image: NDArray[np.uint8],
    lens: Array,
    points: Array,
    normals: Array,
    depth: Array,
    reach: float,
    polarity: float,
    offset: Array,
    contrast: Array,
    information: Array,
    misfit: Array,
    slope: Array,
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
            rise = 0.0
            for j in range(1, half + 1):
                rise += grey[k + j] - grey[k - j]
            rise /= half
            if np.isnan(rise):
                continue
            d = float(start + k)
            value = polarity * rise * (1.0 - 0.4 * (d / (reach + 1.0)) ** 2)
            if value > best:
                best, offset[e], contrast[e], found[e] = value, d, rise, True
        information[e], misfit[e], slope[e] = 1.0, 0.0, 0.0


def find_edges(
    image: NDArray[np.uint8],
    expected: Outline,
    lens: Lens,
    reach: float,
    polarity: float,
    sharp: bool,
    blur: float = 1.0,
    smear: Array | float = 0.0,
    around: Surroundings | None = None,
) -> Edges:
    """Look for each expected edge within reach [px] of its place.

    blur [px] is the lens'; smear [px], how far the edge moves while the shutter is open, is one each (E,) or one for
    all. around: the greys beside the edges where they are known already; they are fitted where it is None.

    polarity is +1 for an arm darker than its ground, -1 for a lighter one. sharp: sub-pixel, from the whole profile,
    right where the edge is within about 2 px; otherwise the strongest step, to a pixel, from anywhere within reach.
    """
    count = len(expected.points)
    result = Edges(*(np.zeros(count) for _ in range(6)), found=np.zeros(count, dtype=np.bool_))
    out = (result.offset, result.contrast, result.information, result.misfit, result.slope, result.level, result.found)
    place = (image, lens.packed, expected.points, expected.normals, expected.depth)
    if sharp:
        half = 0.5 * np.broadcast_to(np.asarray(smear, dtype=float), count)
        none = np.zeros(count)
        grey = (none, none, none) if around is None else (around.slope, around.level, around.contrast)
        _sharp(*place, float(blur), half, *grey, around is not None, float(reach), *out)
        result.found[:] &= polarity * result.contrast > 0
    else:
        _wide(*place, float(reach), float(polarity), *out[:-2], result.found)
    return result


@njit(cache=True, nogil=True)
def grey_at(image: NDArray[np.uint8], lens: Array, points: Array) -> Array:
    """Bilinear grey levels (N,) at points (N, 2) of the ideal picture; NaN outside."""
    values = np.empty(points.shape[0])
    for k in range(points.shape[0]):
        u, v = bend_point(points[k, 0], points[k, 1], lens)
        values[k] = _grey(image, u, v)
    return values
