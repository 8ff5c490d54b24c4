"""The two ends of an arm, searched along its course: their places, and whether the sides agree with them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tentacle.signals import Array
from vision.edge_look import EdgeLook
from vision.edges import Optics, fit_edges, search_edges
from vision.kinematics import Outline
from vision.motion import Sweep
from vision.robust import MISFIT

NARROW = 2.5  # px, reach of a profile about an end
CONTRADICTED = 2.0  # px: an end farther than this from the expected place is checked against the sides in between
SIDEWAYS = 1.0  # of the radius there, that an end may move sideways in an exposure; its middle half is looked at


@dataclass(frozen=True)
class EndSearch:
    """Parameters of the search for an end: reach [px] along the arm, and the usual rms [grey] of a side's profile."""

    optics: Optics
    sight: EdgeLook
    reach: float
    usual: float


def arm_end(
    image: NDArray[np.uint8], expected: Outline, kind: int, find: EndSearch, swept: Sweep
) -> tuple[NDArray[np.intp], Array]:
    """Indices of an end's edges, and their offsets [px]; 0 for edges that do not look like the sides (a clamp hides
    them) or that move sideways (the end's corners pass over them).
    """
    optics, sight = find.optics, find.sight
    index = np.flatnonzero(expected.kind == kind)
    names = ("points", "normals", "depth", "jacobian", "s", "kind", "bulge", "span")
    rows = Outline(*(getattr(expected, name)[index] for name in names))
    nothing = np.zeros(len(index))
    if swept.slip[index].max() > SIDEWAYS * 2.0 * expected.span[index].sum():
        return index, nothing
    swept = Sweep(swept.width[index], swept.shift[index], swept.slip[index])
    coarse = search_edges(image, rows, optics.lens, find.reach, optics.polarity)
    like = sight.polarity * coarse.contrast
    usually = sight.contrast_at(rows.s)
    alike = coarse.found & (like > 0.5 * usually) & (like < 1.6 * usually)
    if np.count_nonzero(alike) < max(0.7 * len(index), 1):
        return index, nothing
    shift = float(np.median(coarse.offset[alike]))
    rows = replace(rows, points=rows.points + shift * rows.normals)
    sharp = fit_edges(image, rows, optics, NARROW, swept)
    middle = float(np.median(sharp.offset[sharp.found])) if sharp.found.any() else 0.0
    agree = sharp.found & (np.abs(sharp.offset - middle) < 0.5) & (sharp.misfit < MISFIT * find.usual)
    if np.count_nonzero(agree) < max(0.7 * len(index), 1):
        return index, nothing
    return index, np.asarray(np.where(agree, shift + sharp.offset, 0.0))


def agrees_with_sides(expected: Outline, end: NDArray[np.intp], offset: Array, carries: NDArray[np.bool_]) -> bool:
    """Whether an end found before its expected place is real: beyond a real end there are no sides.

    If the arm bends away from its expected course, the line of the search leaves the arm at its flank, which looks like
    an end.
    """
    seen = offset[offset != 0.0]
    short = -float(np.median(seen)) if len(seen) else 0.0
    if short < CONTRADICTED:
        return True
    apart = np.linalg.norm(expected.points - expected.points[end].mean(axis=0), axis=1)
    beyond = (expected.kind < 2) & (apart < short)
    return float(carries[beyond].mean()) < 0.5 if beyond.any() else True
