"""The lens, with the water and glass in front of it, as one radial term: it maps points of an ideal picture to the real
one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tentacle.compiled import njit
from tentacle.signals import Array

STRAIGHTENED = 20  # steps of the inverse; a lens of 5 % at the corner needs nine for 1e-6 px


@dataclass(frozen=True)
class Lens:
    """A point at distance r from the centre (u, v) [px] is seen at r (1 + k1 x + k2 x^2), x = (r / reference)^2.

    The default has no distortion. `tentacle calibrate` measures it from a board that stands in the arm's plane, in the
    water, so that refraction is part of it. metres_per_px is the board's scale in that plane, None where not measured.
    """

    centre: tuple[float, float] = (0.0, 0.0)
    reference: float = 1.0
    k1: float = 0.0
    k2: float = 0.0
    metres_per_px: float | None = None

    @property
    def packed(self) -> Array:
        """(cu, cv, 1 / reference^2, k1, k2), as the compiled code takes it."""
        return np.array([*self.centre, 1.0 / self.reference**2, self.k1, self.k2])

    def bend(self, px: Array) -> Array:
        """Map points (..., 2) of the ideal picture to the real picture [px]."""
        offset = np.asarray(px, dtype=float) - self.centre
        x = np.sum(offset**2, axis=-1, keepdims=True) / self.reference**2
        return np.asarray(self.centre) + offset * (1.0 + x * (self.k1 + x * self.k2))

    def straighten(self, px: Array) -> Array:
        """Map points (..., 2) of the real picture to the ideal picture [px]: the inverse of bend, by fixed points."""
        seen = np.asarray(px, dtype=float)
        ideal = seen
        for _ in range(STRAIGHTENED):
            ideal = ideal + seen - self.bend(ideal)
        return ideal


@njit(cache=True, inline="always")
def bend_point(u: float, v: float, lens: Array) -> tuple[float, float]:
    """Map one point by the packed lens."""
    x, y = u - lens[0], v - lens[1]
    r = (x * x + y * y) * lens[2]
    factor = 1.0 + r * (lens[3] + r * lens[4])
    return lens[0] + x * factor, lens[1] + y * factor
