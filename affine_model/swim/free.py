"""Free swimming: the hull's path and yaw over a run, and the speed and drift that are read from them.

    heading h = mean of (sin psi, -cos psi) over the window, made a unit vector;   speed = h . displacement / time
    yaw drift = (mean of psi over the window's second half - over its first half) / half its time

psi = theta - delta(t) is the hull's yaw (affine_model.free_body), and forward is -t, away from the tip. A gait that
turns has a small speed: its displacement bends away from its mean heading.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from affine_model.advance import Drive, State, at_rest
from affine_model.arm import Arm
from affine_model.curvature import Array


@dataclass(frozen=True)
class HullCourse:
    """place (K, 2, B) [m] of the hull and its yaw (K, B) [rad] in the tank, at even times."""

    place: Array
    yaw: Array

    def after(self, first: int) -> HullCourse:
        """The course from the place `first` on."""
        return HullCourse(self.place[first:], self.yaw[first:])


def launched(arm: Arm, drive: Drive, delta: Array) -> State:
    """Straight arms and hulls at rest; of delta (3, B) the angle and rate that the servo begins with."""
    state = at_rest(arm, delta.shape[1], drive)
    state.u[arm.order], state.u_rate[arm.order] = delta[0], delta[1]
    return state


def hull_course(arm: Arm, u: Array, delta: Array) -> HullCourse:
    """The hull's course, from states u (K, D, B) and the servo's angle delta (K, B) at their times."""
    n = arm.order
    return HullCourse(u[:, [n + 2, n + 1]], u[:, n] - delta)


def forward_speed(course: HullCourse, seconds: float) -> Array:
    """Mean speed (B,) [m/s] along the mean heading, over a course of that many seconds."""
    heading = np.stack([np.sin(course.yaw).mean(axis=0), -np.cos(course.yaw).mean(axis=0)])
    heading = heading / np.maximum(np.linalg.norm(heading, axis=0), 1e-12)
    return np.einsum("xb,xb->b", heading, course.place[-1] - course.place[0]) / seconds


def yaw_drift(course: HullCourse, seconds: float) -> Array:
    """Mean turning rate (B,) [rad/s] over a course of that many seconds."""
    middle = len(course.yaw) // 2
    return (course.yaw[middle:].mean(axis=0) - course.yaw[:middle].mean(axis=0)) / (0.5 * seconds)
