"""The plane in which a spatial arm moves, and the share of its motion out of it.

A planar model is valid for a spatial arm if its points stay in one plane. The plane holds the direction of the arm at
rest; its normal in the arm's cross-section is the principal axis of the points' displacements.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tentacle.signals import Array


@dataclass(frozen=True)
class Plane:
    """along, normal, across (3,): unit vectors along the arm at rest, along the motion, and out of the plane;
    out_of_plane: rms displacement out of the plane over the whole rms displacement across the arm.
    """

    along: Array
    normal: Array
    across: Array
    out_of_plane: float

    def coordinates(self, points: Array) -> Array:
        """Points (..., 3) as (..., 2): along the motion and along the arm."""
        return np.stack([points @ self.normal, points @ self.along], axis=-1)

    def aside(self, points: Array) -> Array:
        """Points (..., 3) as their distance (...) out of the plane."""
        return points @ self.across


def plane_of_motion(displacement: Array, along: Array) -> Plane:
    """The plane of displacements (..., 3) [m] from rest of an arm that lies along a direction (3,) then.

    The normal points to the side of the first displacement.
    """
    along = along / np.linalg.norm(along)
    flat = displacement.reshape(-1, 3)
    flat = flat[np.isfinite(flat).all(axis=1)]
    sideways = flat - np.outer(flat @ along, along)
    _, sizes, axes = np.linalg.svd(sideways, full_matrices=False)
    normal = axes[0] - (axes[0] @ along) * along
    normal = normal / np.linalg.norm(normal)
    normal = normal if float(sideways[0] @ normal) >= 0.0 else -normal
    share = float(sizes[1] / np.hypot(sizes[0], sizes[1])) if sizes[0] > 0 else 0.0
    return Plane(along, normal, np.asarray(np.cross(normal, along), dtype=float), share)
