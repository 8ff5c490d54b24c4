"""Greys beside an edge from its pixels: normal equations of its levels, and its plateaus."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tentacle.compiled import njit
from tentacle.signals import Array
from vision.blurred_step import bar_is_thin, bar_share, steepness
from vision.profiles import Bars, Pixels

BEYOND = 2.0  # distance from an edge to its plateaus, in blurs


@njit(cache=True, nogil=True)
def level_sums(pixels: Pixels, bars: Bars, ratio: float, inside: Array, fade: Array) -> Array:
    """Normal equations of each edge's greys about its expected place, packed for levels.side_greys: (E, 16).

    Unknowns: grey inside and outside at the edge, slope of the ground outward [grey/px] (inside it is ratio times
    that), and contrast times a shift, so that a small error of the place does not bias the greys. inside (E, 2): grey
    and slope of the arm that are subtracted first. fade (E,): share of the light that the body takes there, over the
    usual share; the grey inside is that of a body without fade. Packed: lower triangle of the matrix (10), right side
    (4), sum of squares, number of pixels.
    """
    start, grey, place = pixels
    depth, blur, half = bars
    packed = np.zeros((len(start) - 1, 16))
    row = np.empty(4)
    for e in range(len(start) - 1):
        thin = bar_is_thin(depth[e], blur, half[e])
        for k in range(start[e], start[e + 1]):
            c = 1.0 - fade[e] * (1.0 - bar_share(place[k], depth[e], blur, half[e], thin))
            row[0], row[1], row[2] = 1.0 - c, c, (ratio + (1.0 - ratio) * c) * place[k]
            row[3] = fade[e] * steepness(place[k], blur, half[e])
            rest = grey[k] - (1.0 - c) * (inside[e, 0] + inside[e, 1] * place[k])
            at = 0
            for i in range(4):
                packed[e, 10 + i] += row[i] * rest
                for j in range(i + 1):
                    packed[e, at] += row[i] * row[j]
                    at += 1
            packed[e, 14] += rest * rest
            packed[e, 15] += 1.0
    return packed


@njit(cache=True, nogil=True)
def plateaus(pixels: Pixels, bars: Bars, contrast: Array, tell: NDArray[np.bool_]) -> Array:
    """Inside and outside of the selected edges (E,), beyond the blur: (E, 2, 3).

    Number of pixels, mean grey, mean distance outward [px]. The remaining influence of the blur, from contrast (E,)
    [grey], is subtracted.
    """
    start, grey, place = pixels
    depth, blur, half = bars
    found = np.zeros((len(start) - 1, 2, 3))
    for e in range(len(start) - 1):
        if not tell[e]:
            continue
        fuzzy = BEYOND * blur + half[e]
        thin = bar_is_thin(depth[e], blur, half[e])
        for k in range(start[e], start[e + 1]):
            if abs(place[k]) < fuzzy:
                continue
            side = 1 if place[k] > 0.0 else 0
            found[e, side, 0] += 1.0
            found[e, side, 1] += grey[k] + contrast[e] * (side - bar_share(place[k], depth[e], blur, half[e], thin))
            found[e, side, 2] += place[k]
        for side in range(2):
            found[e, side, 1:] /= max(found[e, side, 0], 1.0)
    return found
