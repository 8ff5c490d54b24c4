"""The recording's parameters g from its first frames, before all frames are pooled."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tentacle.signals import Array
from vision.fit import FrameFit
from vision.kinematics import SHARED, Geometry
from vision.slow_waves import inflation
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


@dataclass(frozen=True)
class Reach:
    """How far one frame shows the arm: share of its length (NaN if unknown), and the arm's direction at its base (2,),
    a unit vector in the picture. A base that lies farther along it leaves the arm shorter.
    """

    share: float
    along: Array


def settle(
    shared: Array, geometry: Geometry, fits: list[FrameFit], reaches: list[Reach], share: float
) -> tuple[Array, tuple[Array, Array]]:
    """One Gauss-Newton step of g (G,) over several frames, each frame's x eliminated (Schur complement).

    Gives the new g, and the information (G, G) and gradient (G,) of the reach on it. share: weight of the sides'
    information. The frames' usual reach (reach.seen_reach) gives the tip's place, so the length together with the
    base's place along the arm. What the sides say of the tip can be wrong, because it absorbs shapes that the
    coordinates cannot follow. So their weight is reduced by their errors' slow waves, and further if reach and sides
    contradict each other, until they agree (pool).
    """
    prior = prior_of(geometry)
    towards, off = _tip(shared, geometry.length, reaches)
    told = np.outer(towards, towards) / REACH_ERROR**2, towards * off / REACH_ERROR**2
    power, staying = inflation(np.array([fit.waves for fit in fits]))
    share /= power * staying
    parts = [eliminate(fit)[2:] for fit in fits]
    sides = sum((part for part, _ in parts), np.zeros((SHARED, SHARED)))
    slope = sum((slope for _, slope in parts), np.zeros(SHARED))
    while True:
        information = np.diag(prior**-2) + share * sides
        alone = np.linalg.inv(information)
        stated = float(towards @ alone @ towards)
        apart = float(towards @ alone @ (share * slope - shared / prior**2) - off) ** 2
        if not towards.any() or apart < CONTRADICTION * (stated + REACH_ERROR**2):
            break
        share *= 0.5 * stated / (apart - REACH_ERROR**2)
    step = np.linalg.solve(information + told[0], share * slope - shared / prior**2 + told[1])
    return shared + step, (told[0], told[1] - told[0] @ step)


def _tip(shared: Array, length: float, reaches: list[Reach]) -> tuple[Array, float]:
    """Change (G,) of the tip's place along the arm, over the declared length [px], per unit of g, and its error.

    Zeros if no frame shows it.
    """
    seen = [reach for reach in reaches if np.isfinite(reach.share)]
    if not seen:
        return np.zeros(SHARED), 0.0
    towards = np.zeros(SHARED)
    towards[:2] = np.mean([reach.along for reach in seen], axis=0) / length
    towards[2] = 1.0
    return towards, float(np.median([reach.share for reach in seen]) - 1.0) * (1.0 + float(shared[2]))
