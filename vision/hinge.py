"""Where a body that is still at one end begins to move, from its midlines in several pictures of a film.

A fish's trunk goes over into its tail without a corner, so that no outline says where the tail is held. Up to the place
s0 the body stands still; beyond it, it swings. Its distance sideways from the mean line at time t is

    y(t, s) = sum_k c_k(t) (s - s0)^k for s > s0, k = 1 .. K, and 0 before,

as of an arm that turns and bends beyond s0. s0 is the place with the least sum of squares over all pictures, and K the
order with the least AIC (Akaike 1974).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from tentacle.signals import Array

ORDERS = (2, 3, 4)  # of the polynomial beyond the place: a turn, and curvature up to the second power of the distance
INDEPENDENT = 8.0  # px along a body's mean axis that err independently: the axis is smoothed over so many
STEP = 1.0  # px between the tried places, and between the points compared
END, LAST, USED = 0.04, 0.6, 0.75  # of the body: what its contour's end may spoil, places tried up to, compared up to
LEAST_PICTURES = 5
ALIKE, SHARP = 1.1, 0.15  # places with so many times the least sum are as good; of the body: their largest range
LEAST_MOTION = 1.0  # px, rms over the pictures at the end of the part that is compared


def motion_begins(lines: Sequence[Array]) -> float | None:
    """Arc length [px] from the still end of lines (P, 2) [px] at which they begin to move.

    None where they do not move, are too few, or do not tell the place.
    """
    if len(lines) < LEAST_PICTURES:
        return None
    arcs = [np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))]) for line in lines]
    length = min(float(arc[-1]) for arc in arcs)
    s = np.arange(END * length, USED * length, STEP)
    points = np.array(
        [[np.interp(s, arc, line[:, k]) for k in (0, 1)] for arc, line in zip(arcs, lines, strict=True)]
    ).transpose(0, 2, 1)
    mean = points.mean(axis=0)
    along = np.gradient(mean, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    off = points - mean
    sideways = off[:, :, 1] * along[:, 0] - off[:, :, 0] * along[:, 1]  # (T, S)
    if np.sqrt(np.mean(sideways[:, -1] ** 2)) < LEAST_MOTION:
        return None
    places = np.arange(s[0], LAST * length, STEP)
    left = _left_over(s, places, sideways)
    alike = places[left < ALIKE * left.min()]
    if np.ptp(alike) > SHARP * length or alike[0] == places[0] or alike[-1] == places[-1]:
        return None
    return float(places[np.argmin(left)])


def _left_over(s: Array, places: Array, sideways: Array) -> Array:
    """Sums of squares (N,) of sideways (T, S) that polynomials beyond each place leave, of the order of least AIC."""
    count = sideways.size * STEP / INDEPENDENT
    sums = [np.array([_rest(np.clip(s - place, 0.0, None), sideways, order) for place in places]) for order in ORDERS]
    aic = [
        count * np.log(left.min() / sideways.size) + 2.0 * order * len(sideways)
        for order, left in zip(ORDERS, sums, strict=True)
    ]
    return sums[int(np.argmin(aic))]


def _rest(beyond: Array, sideways: Array, order: int) -> float:
    """Sum of the squares of sideways (T, S) that no polynomial of the distance beyond the place (S,) explains."""
    rows = np.stack([beyond**k for k in range(1, order + 1)], axis=1)
    rows /= np.maximum(np.abs(rows).max(axis=0), 1e-12)
    found = np.linalg.lstsq(rows, sideways.T, rcond=None)[0]
    return float(np.sum((sideways.T - rows @ found) ** 2))
