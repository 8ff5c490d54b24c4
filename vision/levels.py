"""The greys beside the arm's edges, from all pixels of a stretch of one side together.

A gradient of the light across the edge changes arm and ground in proportion, so one slope is used for both. Two free
slopes would cost three quarters of the information on the edge's place. There is also one slope along the edge. Without
it, uneven light would move an edge beside a gap, because there the stretch lies to one side of its middle.

A long stretch has less noise, a short one follows uneven light. Lepski's rule chooses the length at each place: the
longest stretch whose edge agrees with those of the shorter ones within their noise (Lepski 1991).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tentacle.compiled import njit
from tentacle.signals import Array
from vision.profiles import Bars, Pixels

STRETCHES = np.array([16, 45, 130, 400])  # stations to either side
DIFFERENT = 2.0  # standard deviations
BELIEVED = 4.0  # standard deviations by which light and picture may differ
LEAST_EDGES = 4  # in a stretch
KNOT = 8  # stations between two places with greys; linear in between
SUMS_KEPT = 24  # number of sums along a side
UNKNOWN_PRIOR = 1e-6  # prior information on each unknown, so that a stretch without an outside has a solution
TAKEN = 1e9  # prior information on the grey inside if it is subtracted


class KnownLight(NamedTuple):
    """Greys (E, 4) beside the edges from earlier pictures, and for which edges they are known (E,)."""

    greys: Array
    known: NDArray[np.bool_]


@njit(cache=True, nogil=True)
def count_strange(pixels: Pixels, bars: Bars, inside: Array, outside: Array, limit: float) -> NDArray[np.int64]:
    """Number of each edge's pixels (E,), except those within the blur, that differ by more than limit from inside and
    outside (E,) [grey].
    """
    start, grey, place = pixels
    _, blur, half = bars
    strange = np.zeros(len(start) - 1, dtype=np.int64)
    for e in range(len(start) - 1):
        fuzzy = 2.0 * blur + half[e]
        for k in range(start[e], start[e + 1]):
            if abs(place[k]) > fuzzy and abs(grey[k] - (outside[e] if place[k] > 0.0 else inside[e])) > limit:
                strange[e] += 1
    return strange


@njit(cache=True, nogil=True)
def side_greys(
    kind: Array, sound: NDArray[np.bool_], packed: Array, ratio: float, known: KnownLight, packed_outside: Array
) -> tuple[Array, NDArray[np.bool_], float]:
    """Greys (E, 4) along both sides, at the edge: inside, outside, slopes outward of ground and arm; which are known.

    packed (E, 16): profiles.level_sums of the sound edges (E,). ratio: the arm's grey over the ground's. known: the
    same greys from earlier pictures; packed_outside (E, 16): sums minus the known grey of the arm, or (0, 16). The
    picture's own greys are used only at places where it contradicts the known ones; the share of such places is
    returned too.
    """
    lit, known_light = known
    count, contradicted, places = len(kind), 0, 1
    greys, sure = np.zeros((count, 4)), np.zeros(count, dtype=np.bool_)
    window, answer = np.empty(SUMS_KEPT), np.empty(6)
    for side in (0, 1):
        index = np.flatnonzero(kind == side)
        stations = len(index)
        if stations == 0:
            continue
        total = _running_sums(index, sound, packed, ratio)
        without = len(packed_outside) > 0
        outside = _running_sums(index, sound & known_light, packed_outside, 0.0) if without else total
        knots = (stations - 1) // KNOT + 2
        told, there = np.zeros((knots, 4)), np.zeros(knots, dtype=np.bool_)
        noises = np.empty(knots)
        for knot in range(knots):
            k = min(knot * KNOT, stations - 1)
            window[:] = total[min(k + STRETCHES[0] + 1, stations)] - total[max(k - STRETCHES[0], 0)]
            _solve(window, k, ratio, UNKNOWN_PRIOR, answer)
            noises[knot] = answer[5]
        noise = np.median(noises)
        for knot in range(knots):
            k = min(knot * KNOT, stations - 1)
            e = index[k]
            there[knot], middle, variance = _longest(total, k, ratio, UNKNOWN_PRIOR, noise, answer)
            told[knot, :3], told[knot, 3] = answer[:3], ratio * answer[2]
            if not known_light[e]:
                continue
            places += 1
            if not there[knot] or (0.5 * (lit[e, 0] + lit[e, 1]) - middle) ** 2 <= BELIEVED**2 * noise * variance:
                told[knot], there[knot] = lit[e], True
                continue
            contradicted += 1
            if not without:
                continue
            # something is beside the arm, such as a mirror image: the arm's own grey is still known
            found, half_way, _ = _longest(outside, k, 0.0, TAKEN, noise, answer)
            if found and (half_way + 0.5 * lit[e, 0] - middle) ** 2 <= BELIEVED**2 * noise * variance:
                told[knot, 0], told[knot, 1:3], told[knot, 3] = lit[e, 0], answer[1:3], lit[e, 3]
        for k in range(stations):
            e, knot = index[k], k // KNOT
            part = (k - knot * KNOT) / KNOT
            sure[e] = there[knot] and there[knot + 1]
            for i in range(4):
                greys[e, i] = (1.0 - part) * told[knot, i] + part * told[knot + 1, i]
    return greys, sure, contradicted / places


@njit(cache=True, nogil=True)
def _running_sums(index: NDArray[np.int64], sound: NDArray[np.bool_], packed: Array, ratio: float) -> Array:
    """Running sums (stations + 1, SUMS) along a side: packed of the sound edges, and the terms with a slope."""
    total, row = np.zeros((len(index) + 1, SUMS_KEPT)), np.zeros(SUMS_KEPT)
    for k in range(len(index)):
        e = index[k]
        total[k + 1] = total[k]
        if sound[e]:
            row[:16], row[16] = packed[e], 1.0
            _lean(packed[e], ratio, row[17:23])
            row[23] = row[21] * k * k
            row[17:23] *= k
            total[k + 1] += row
    return total


@njit(cache=True, nogil=True)
def _longest(total: Array, k: int, ratio: float, held: float, noise: float, answer: Array) -> tuple[bool, float, float]:
    """Write into answer (6,) the result of the longest stretch about station k that agrees with the shorter ones.

    Returns whether any stretch has enough edges, the half-way grey, and its variance per squared grey of noise.
    """
    stations = total.shape[0] - 1
    there, middle, variance = False, 0.0, np.inf
    window, longer = np.empty(SUMS_KEPT), np.empty(6)
    answer[:] = 0.0
    for reach in STRETCHES:
        window[:] = total[min(k + reach + 1, stations)] - total[max(k - reach, 0)]
        if window[16] < LEAST_EDGES:
            continue
        _solve(window, k, ratio, held, longer)
        if there and (longer[3] - middle) ** 2 > DIFFERENT * DIFFERENT * noise * variance:
            break
        answer[:], middle, variance, there = longer, longer[3], longer[4], True
    return there, middle, variance


@njit(cache=True, inline="always")
def _lean(packed: Array, ratio: float, out: Array) -> None:
    """Into out (6,): products of the light's share ratio (1 - c) + c with the four unknowns' rows, itself, the grey."""
    out[0] = ratio * packed[0] + packed[1]
    out[1] = ratio * packed[1] + packed[2]
    out[2] = ratio * packed[3] + packed[4]
    out[3] = ratio * packed[6] + packed[7]
    out[4] = ratio * out[0] + out[1]
    out[5] = ratio * packed[10] + packed[11]


@njit(cache=True, nogil=True)
def _solve(window: Array, middle: int, ratio: float, held: float, answer: Array) -> None:
    """Into answer (6,): greys (3), the half-way grey, its variance per squared grey of noise, the noise's variance.

    held: prior information on the grey inside. All at station middle; the fifth unknown is the light's slope along the
    side. By Cholesky's factors L of the normal matrix: x = L'^-1 L^-1 b; the half-way grey is h x, its variance
    |L^-1 h|^2.
    """
    factor, half_way, right = np.zeros((5, 5)), np.zeros(5), np.empty(5)
    lean = np.empty(6)
    _lean(window, ratio, lean)
    at = 0
    for i in range(4):
        right[i] = window[10 + i]
        factor[4, i] = window[17 + i] - middle * lean[i]
        for j in range(i + 1):
            factor[i, j] = window[at]
            at += 1
    right[4] = window[22] - middle * lean[5]
    factor[4, 4] = window[23] - 2.0 * middle * window[21] + middle * middle * lean[4]
    half_way[:2] = 0.5
    for i in range(5):
        for j in range(i + 1):
            value = factor[i, j] + ((held if i == 0 else UNKNOWN_PRIOR) if i == j else 0.0)
            for k in range(j):
                value -= factor[i, k] * factor[j, k]
            factor[i, j] = np.sqrt(max(value, 1e-9)) if i == j else value / factor[j, j]
        for k in range(i):
            half_way[i] -= factor[i, k] * half_way[k]
            right[i] -= factor[i, k] * right[k]
        half_way[i] /= factor[i, i]
        right[i] /= factor[i, i]
    explained, answer[4] = 0.0, 0.0
    for i in range(5):
        explained += right[i] * right[i]
        answer[4] += half_way[i] * half_way[i]
    for i in range(4, -1, -1):
        for k in range(i + 1, 5):
            right[i] -= factor[k, i] * right[k]
        right[i] /= factor[i, i]
        if i < 3:
            answer[i] = right[i]
    answer[3] = 0.5 * (right[0] + right[1])
    answer[5] = max(max(window[14] - explained, 0.0) / max(window[15] - 5.0, 1.0), 0.1)
