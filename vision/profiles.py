"""Pixels across the expected outline, each assigned to one edge, and the fit of a blurred step to them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tentacle.compiled import njit
from tentacle.signals import Array
from vision.blurred_step import bar_is_thin, bar_share, steepness, step_softening
from vision.lens import bend_point

MOST_PIXELS = 160  # largest number of pixels of one edge
CHORD = 4.0  # px over which the lens is linearised


class Stations(NamedTuple):
    """Where edges are expected: points (E, 2) [px], outward unit normals (E, 2), span (E,) [px] of the outline to
    either side, bulge (E,) [1/px]."""

    points: Array
    normals: Array
    span: Array
    bulge: Array


class Bars(NamedTuple):
    """Look of each edge: depth (E,) [px] to the opposite edge, blur [px] of the lens, half (E,) [px], half the smear's
    width.
    """

    depth: Array
    blur: float
    half: Array


class Pixels(NamedTuple):
    """Each edge's pixels: rows start (E + 1,) into grey (N,) and place (N,) [px], their distance outward from
    the edge.
    """

    start: NDArray[np.int64]
    grey: Array
    place: Array


class Fitted(NamedTuple):
    """Offset [px], contrast [grey], information, misfit [grey], grey inside of each edge (E,), and whether it was
    found."""

    offset: Array
    contrast: Array
    information: Array
    misfit: Array
    level: Array
    found: NDArray[np.bool_]


class EdgeMeasurement(NamedTuple):
    """Offset [px], information, misfit [grey] of each edge (E,), whether it was found, and softer (E, 2): the normal
    equation for more blur, right side and left."""

    offset: Array
    information: Array
    misfit: Array
    found: NDArray[np.bool_]
    softer: Array


@njit(cache=True, nogil=True)
def gather(image: NDArray[np.uint8], lens: Array, stations: Stations, bars: Bars, reach: float) -> Pixels:
    """Collect each edge's pixels, up to reach [px] beyond its blur.

    A pixel belongs to the edge whose stretch of the outline, span (E,) [px] to either side, faces it. No pixel is
    counted twice and each has its true distance, so that the noise of different edges is independent. An edge whose
    profile leaves the picture has no pixels.
    """
    points, normals, span, bulge = stations
    depth, blur, half = bars
    height, width = image.shape
    count = points.shape[0]
    start = np.zeros(count + 1, dtype=np.int64)
    room = 64 * count
    grey, place = np.empty(room), np.empty(room)
    total = 0
    for e in range(count):
        fuzzy = 2.0 * blur + half[e]
        outer = reach + fuzzy
        inner = min(reach + fuzzy, max(0.5 * depth[e], 1.0))  # beyond the middle a pixel belongs to the other side
        # through the lens: the edge's place, and a px outward, as a chord of the profile
        u, v = bend_point(points[e, 0], points[e, 1], lens)
        a, b = bend_point(points[e, 0] + CHORD * normals[e, 0], points[e, 1] + CHORD * normals[e, 1], lens)
        n_u, n_v = (a - u) / CHORD, (b - v) / CHORD
        scale = 1.0 / (n_u * n_u + n_v * n_v)
        begin, start[e + 1] = total, total
        if not (_within(u + outer * n_u, v + outer * n_v, width, height)):
            continue
        if not (_within(u - inner * n_u, v - inner * n_v, width, height)):
            continue
        # line by line of the picture, along the axis that the normal lies nearer to
        flat = abs(n_u) >= abs(n_v)
        main, other = (n_u, n_v) if flat else (n_v, n_u)
        first, second = (u, v) if flat else (v, u)
        low, high = (-inner, outer) if main > 0 else (outer, -inner)
        widest = span[e] * (1.0 + max(outer * bulge[e], -inner * bulge[e], 0.0))
        slack, wide = widest * abs(other), widest / abs(main * scale)
        for i in range(math.ceil(first + low * main - slack), math.floor(first + high * main + slack) + 1):
            middle = second + (i - first) * other / main
            for j in range(math.ceil(middle - wide), math.floor(middle + wide) + 1):
                x, y = (i, j) if flat else (j, i)
                across = ((x - u) * n_u + (y - v) * n_v) * scale
                along = ((y - v) * n_u - (x - u) * n_v) * scale
                facing = span[e] * (1.0 + across * bulge[e])
                d = across + 0.5 * bulge[e] * along * along  # the edge bends away beside its point
                if not (-facing <= along < facing and -inner <= d <= outer):
                    continue
                if not (0 <= x < width and 0 <= y < height) or total - begin == MOST_PIXELS:
                    continue
                if total == room:
                    room *= 2
                    longer_grey, longer_place = np.empty(room), np.empty(room)
                    longer_grey[:total], longer_place[:total] = grey[:total], place[:total]
                    grey, place = longer_grey, longer_place
                grey[total], place[total] = image[y, x], d
                total += 1
        start[e + 1] = total
    return Pixels(start, grey[:total], place[:total])


@njit(cache=True, inline="always")
def _within(u: float, v: float, width: int, height: int) -> bool:
    return -0.5 <= u < width - 0.5 and -0.5 <= v < height - 0.5


@njit(cache=True, nogil=True)
def fit_profiles(pixels: Pixels, bars: Bars, reach: float) -> Fitted:
    """Fit level inside, contrast and offset of a blurred bar's edge to an edge's own pixels, by Gauss-Newton."""
    start, grey, place = pixels
    depth, blur, half = bars
    edges = len(start) - 1
    offset, contrast, information = np.zeros(edges), np.zeros(edges), np.zeros(edges)
    misfit, level, found = np.zeros(edges), np.zeros(edges), np.zeros(edges, dtype=np.bool_)
    share = np.empty(MOST_PIXELS)
    for e in range(len(start) - 1):
        found[e] = False
        first, count = start[e], start[e + 1] - start[e]
        if count < 4:
            continue
        thin = bar_is_thin(depth[e], blur, half[e])
        delta, total, solved = 0.0, 0.0, False
        for sweep in range(3):  # linear in (level, step); one Newton step in delta follows each solve
            n_c, n_cc, n_y, n_yc = 0.0, 0.0, 0.0, 0.0
            for k in range(count):
                c = bar_share(float(place[first + k] - delta), depth[e], blur, half[e], thin)
                share[k] = c
                y = grey[first + k]
                n_c += c
                n_cc += c * c
                n_y += y
                n_yc += y * c
            spread = n_cc - n_c * n_c / count
            if spread < 1e-3:
                break
            contrast[e] = (n_yc - n_y * n_c / count) / spread
            level[e] = (n_y - contrast[e] * n_c) / count
            # derivative by delta, with level and step projected out (variable projection)
            g_sum, g_c, g_g, r_g, total = 0.0, 0.0, 0.0, 0.0, 0.0
            for k in range(count):
                c = share[k]
                g = -contrast[e] * steepness(place[first + k] - delta, blur, half[e])
                residual = grey[first + k] - level[e] - contrast[e] * c
                g_sum += g
                g_c += g * c
                g_g += g * g
                r_g += residual * g
                total += residual * residual
            fisher = g_g - g_sum * g_sum / count - (g_c - g_sum * n_c / count) ** 2 / spread
            if fisher <= 1e-9:
                break
            solved = True
            if sweep < 2:
                delta += min(max(r_g / fisher, -1.0), 1.0)
            information[e] = fisher
        offset[e] = delta
        misfit[e] = math.sqrt(total / count)
        found[e] = solved and abs(delta) <= reach
    return Fitted(offset, contrast, information, misfit, level, found)


@njit(cache=True, nogil=True)
def measure_profiles(pixels: Pixels, bars: Bars, greys: Array, reach: float) -> EdgeMeasurement:
    """Distance of each edge outward from its expected place, by one linear step with known greys beside it.

    greys (E, 4): inside and outside at the edge, the slopes outward of ground and arm. Pixels farther than reach [px]
    beyond the blur are left out. One linear step is enough because the expected place is right to a small part of the
    blur; it adds no bias to the noise of a faint edge.
    """
    start, grey, place = pixels
    depth, blur, half = bars
    edges = len(start) - 1
    offset, information, misfit = np.zeros(edges), np.zeros(edges), np.zeros(edges)
    found, softer = np.zeros(edges, dtype=np.bool_), np.zeros((edges, 2))
    for e in range(len(start) - 1):
        thin = bar_is_thin(depth[e], blur, half[e])
        g_g, r_g, total = 0.0, 0.0, 0.0
        softer[e] = 0.0
        near, used = reach + 2.0 * blur + half[e], 0
        for k in range(start[e], start[e + 1]):
            if abs(place[k]) > near:
                continue
            used += 1
            c = bar_share(place[k], depth[e], blur, half[e], thin)
            within = greys[e, 0] + greys[e, 3] * place[k]
            beyond = greys[e, 1] + greys[e, 2] * place[k]
            g = -(greys[e, 1] - greys[e, 0]) * steepness(place[k], blur, half[e])
            residual = grey[k] - within - c * (beyond - within)
            h = (greys[e, 1] - greys[e, 0]) * step_softening(place[k], blur, half[e])
            g_g += g * g
            r_g += residual * g
            total += residual * residual
            softer[e, 0] += residual * h
            softer[e, 1] += h * h
        found[e] = g_g > 1e-9
        information[e] = g_g
        offset[e] = r_g / max(g_g, 1e-9)
        misfit[e] = math.sqrt(total / max(used, 1))
    return EdgeMeasurement(offset, information, misfit, found, softer)
