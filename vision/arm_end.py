"""An arm's two ends, looked for along it: where they lie, and whether the sides beside them agree."""

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
CONTRADICTED = 2.0  # px that an end may lie from the expected place without a look at what lies between
SIDEWAYS = 1.0  # of the radius there, that an end may move sideways in an exposure; its middle half is looked at


@dataclass(frozen=True)
class EndSearch:
    """How an end is looked for: up to reach [px] along the arm, with the profile's usual rms [grey] of the sides."""

    optics: Optics
    sight: EdgeLook
    reach: float
    usual: float


def arm_end(
    image: NDArray[np.uint8], expected: Outline, kind: int, find: EndSearch, swept: Sweep
) -> tuple[NDArray[np.intp], Array]:
    """Indices of an end's edges, and their offsets [px]; 0 where it does not look as the sides do (a
    clamp hides it), or moves sideways (its corners pass)."""
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
    """Whether an end that lies short of its expected place leaves no sides beyond it: an arm has none where it is not.

    Where the arm bends away from its expected course, the line on which its end is looked for leaves it by its flank.
    """
    seen = offset[offset != 0.0]
    short = -float(np.median(seen)) if len(seen) else 0.0
    if short < CONTRADICTED:
        return True
    apart = np.linalg.norm(expected.points - expected.points[end].mean(axis=0), axis=1)
    beyond = (expected.kind < 2) & (apart < short)
    return float(carries[beyond].mean()) < 0.5 if beyond.any() else True
