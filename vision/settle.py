"""The recording's parameters g from its first frames, before all frames are pooled."""

from __future__ import annotations

import numpy as np

from tentacle.signals import Array
from vision.fit import FrameFit
from vision.kinematics import SHARED, Geometry
from vision.tracked_frame import eliminate

PRIOR = np.array([30.0, 30.0, 0.08, 1.5, 3.0, 3.0])  # px, px, relative, px: usual errors of a declaration
SHORT, SLENDER = 0.065, (0.4, 0.8, 0.8)  # limits: of a short arm's length, of a slender arm's half thickness
REACH_ERROR = 0.02  # of the length: error of the first frames' common reach
CONTRADICTION = 9.0  # chi-square above which the lengths from reach and sides contradict each other


def prior_of(geometry: Geometry) -> Array:
    """Prior errors (G,) of an arm's declaration: the usual ones, limited to a share of a small arm's size."""
    base = min(PRIOR[0], SHORT * geometry.length)
    radius = np.minimum(PRIOR[3:], np.array(SLENDER) * float(geometry.radius.max()))
    return np.concatenate([[base, base, PRIOR[2]], radius])


def settle(
    shared: Array, prior: Array, fits: list[FrameFit], reaches: list[float], share: float
) -> tuple[Array, tuple[Array, Array]]:
    """One Gauss-Newton step of g (G,) over several frames, each frame's x eliminated (Schur complement).

    Gives the new g, and the information (G, G) and gradient (G,) of the reach on it. share: weight of the sides'
    information. The frames' usual reach (reach.seen_reach) also gives the length. The sides' length can be wrong,
    because it absorbs shapes that the coordinates cannot follow. If the two lengths contradict each other, the weight
    of the sides is reduced until they agree (pool).
    """
    told = np.zeros((SHARED, SHARED)), np.zeros(SHARED)
    off = 0.0
    if np.isfinite(reaches).any():
        off = (float(np.nanmedian(reaches)) - 1.0) * (1.0 + shared[2])
        told[0][2, 2], told[1][2] = REACH_ERROR**-2, off / REACH_ERROR**2
    parts = [eliminate(fit)[2:] for fit in fits]
    sides = sum((part for part, _ in parts), np.zeros((SHARED, SHARED)))
    slope = sum((slope for _, slope in parts), np.zeros(SHARED))
    while True:
        information = np.diag(prior**-2) + share * sides
        alone = np.linalg.inv(information)
        apart = float((alone @ (share * slope - shared / prior**2))[2] - off) ** 2
        if not told[0].any() or apart < CONTRADICTION * (alone[2, 2] + REACH_ERROR**2):
            break
        share *= 0.5 * alone[2, 2] / (apart - REACH_ERROR**2)
    step = np.linalg.solve(information + told[0], share * slope - shared / prior**2 + told[1])
    return shared + step, (told[0], told[1] - told[0] @ step)
