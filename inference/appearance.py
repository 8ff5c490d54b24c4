"""What instruments see of an arm at a recording's instants, before any noise."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from affine_model.acceleration_beside import Turning
from affine_model.curvature import Array


@dataclass(frozen=True)
class Motion:
    """How the arm moves at these instants: q' and q'' (2, T, n, B) in the paper's coordinates, the root's turning
    theta' and theta'' (2, T, B); pull (T, 2, B) [m/s^2], gravity minus the base's acceleration.
    """

    q: Array
    theta: Array
    pull: Array

    def of(self, lanes: slice) -> Self:
        """The same of some of the individuals."""
        return replace(self, q=self.q[..., lanes], theta=_of(self.theta, lanes), pull=_of(self.pull, lanes))

    def stopped(self) -> Self:
        """The same instants of an arm at rest."""
        return replace(self, q=0.0 * self.q, theta=0.0 * self.theta)


@dataclass(frozen=True)
class Appearance:
    """The arm at an observation's T instants: q (T, n, B); theta (T, B), the direction of its root, which is the base's
    angle and the turn of the root (Arm.root_turn); roll [rad] and excess of scale (B,) of the camera, and shift (2, B)
    [m] of the clamp in its picture; zeros (G, B) of the sensors on the arm, (1, B) where all are 0; motion: None where
    it is not known, and then an accelerometer says nothing. shear (n + 1, n): how sections stand askew by q
    (affine_model.shear.Shear.gamma; None: square to the midline).
    """

    q: Array
    theta: Array
    roll: Array
    excess: Array
    shift: Array
    zeros: Array
    motion: Motion | None = None
    shear: Array | None = None

    @staticmethod
    def as_declared(q: Array, theta: Array) -> Appearance:
        """Seen by a camera that stands where it was declared, and by sensors whose zeros are 0."""
        none = np.zeros(q.shape[2])
        return Appearance(q, theta, none, none, np.zeros((2, none.size)), none[None])

    def of(self, lanes: slice) -> Self:
        """What is seen of some of the individuals."""
        return replace(
            self,
            q=self.q[..., lanes],
            theta=_of(self.theta, lanes),
            roll=self.roll[lanes],
            excess=self.excess[lanes],
            shift=_of(self.shift, lanes),
            zeros=_of(self.zeros, lanes),
            motion=self.motion and self.motion.of(lanes),
        )

    def bending(self) -> Array:
        """Coordinates (T, n, B) of the sections' curvature d psi / ds."""
        if self.shear is None:
            return self.q
        return np.asarray(self.q - (np.arange(1, len(self.shear))[:, None] * self.shear[1:]) @ self.q)

    def turning(self) -> Turning | None:
        """The arm's directions and their derivatives; None where they are not known."""
        if self.motion is None:
            return None
        return Turning(
            np.concatenate([self.q[None], self.motion.q]),
            np.concatenate([self.theta[None], self.motion.theta]),
            self.shear,
        )


def _of(rows: Array, lanes: slice) -> Array:
    """Rows (..., B) of some of the individuals, or (..., 1), which all share."""
    return rows if rows.shape[-1] == 1 else rows[..., lanes]
