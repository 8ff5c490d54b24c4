"""An arm as a tube to draw: its midline thinned to a few straight pieces, each with the section's radius."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tentacle.signals import Array
from tentacle.specimen import Specimen

TUBE_PIECES = 24  # a smooth bend at any zoom that shows the whole arm, at a quarter of the file size of 100 points


@dataclass(frozen=True)
class Tube:
    """Straight pieces of an arm over time: ends (N, 2, 3) [m], radius (N,) [m], pieces present per instant (T,)."""

    ends: NDArray[np.float32]
    radius: NDArray[np.float32]
    lengths: NDArray[np.int64]


def planar_to_space(xy: Array) -> NDArray[np.float32]:
    """Base frame (..., 2) [m] to the drawn space (..., 3): the plane of motion is z = 0."""
    return np.concatenate([xy, np.zeros((*xy.shape[:-1], 1))], axis=-1).astype(np.float32)


def thin(count: int, pieces: int = TUBE_PIECES) -> NDArray[np.int64]:
    """Indices of at most pieces + 1 of `count` points, the ends always among them."""
    return np.unique(np.linspace(0, count - 1, min(count, pieces + 1)).round().astype(np.int64))


def tube(xy: Array, s: Array, specimen: Specimen, thickness: float = 1.0, lift: float = 0.0) -> Tube:
    """The tube of a midline xy (T, P, 2) [m] at s (P,); a piece with a missing (NaN) end is left out of its instant.

    thickness scales the section's radius; lift [m] moves the drawing towards the eye, out of the plane of motion.
    """
    keep = thin(len(s))
    points = planar_to_space(xy[:, keep])
    points[..., 2] -= lift
    middle = 0.5 * (s[keep][1:] + s[keep][:-1])
    radius = thickness * specimen.section.half_thickness(np.clip(middle, 0.0, 1.0)).astype(np.float32)
    ends = np.stack([points[:, :-1], points[:, 1:]], axis=2)
    present = np.isfinite(ends).all(axis=(2, 3))
    return Tube(ends[present], np.broadcast_to(radius, present.shape)[present], present.sum(axis=1))
