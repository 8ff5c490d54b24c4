"""What a batch of gaits achieves, by one call of the compiled kernel: gaits in, a few numbers for each out.

The rows of the result: mean forward thrust [N], mean forward speed on the rail or afloat [m/s], mean power [W] and peak
torque [N m] of the servo, time of divergence [s] (-1: none), and the factor <= 1 on the amplitudes that brought the
gait within the servo's limits.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from affine_model.advance import Drive, Pace, advance, at_rest
from affine_model.arm import Arm
from affine_model.curvature import Array
from affine_model.swim.free import forward_speed, hull_course, launched
from affine_model.swim.gaits import gait_tables

ROWS = 6


@dataclass(frozen=True)
class Bounds:
    """The servo's largest angle [rad], speed [rad/s] and acceleration [rad/s^2] (3,), and its bandwidth [Hz]."""

    kinematic: Array
    bandwidth: float

    def scale(self, peaks: Array) -> Array:
        """The factor (B,) <= 1 on the amplitudes that brings peaks (3, B) within the limits (gaits are linear)."""
        with np.errstate(divide="ignore"):
            return np.minimum(1.0, np.min(self.kinematic[:, None] / peaks, axis=0))


def evaluate(
    arm: Arm, drive: Drive, genes: Array, parameters: Array, bounds: Bounds, timing: tuple[Pace, int]
) -> Array:
    """(6, B, K) of B gaits (B, 9) on K samples of parameters (R, K), from rest.

    timing: the pace, whose average_from is even and whose stride is 2, and the number of steps.
    """
    pace, steps = timing
    count, samples = genes.shape[0], parameters.shape[1]
    table, peaks = gait_tables(genes.T, steps, pace.step, bounds.bandwidth, 0.5 * pace.step)
    scale = bounds.scale(peaks)
    table *= scale
    base = np.repeat(table, samples, axis=2) if samples > 1 else table
    state, kept = at_rest(arm, count * samples, drive), np.zeros((3, 0, count * samples))
    if drive.hull is not None:
        kept, _ = gait_tables(genes.T, steps // 2 + 1, 2.0 * pace.step, bounds.bandwidth)
        kept = np.repeat(kept * scale, samples, axis=2)
        state = launched(arm, drive, kept[:, 0])
    course = advance(arm, drive, np.tile(parameters, count), base, (np.zeros(count * samples), state), pace)
    settled, seconds = pace.average_from // 2, (steps - pace.average_from) * pace.step
    rail, summary = course.u[:, arm.order + 1], course.summary
    found = np.empty((ROWS, count * samples))
    found[0], found[1] = -summary[1], -(rail[-1] - rail[settled]) / seconds
    if drive.hull is not None:
        found[1] = forward_speed(hull_course(arm, course.u, kept[0]).after(settled), seconds)
    found[2], found[3] = summary[2], np.max(np.abs(course.force[settled:, 3]), axis=0)
    found[4], found[5] = summary[4], np.repeat(scale, samples)
    return found.reshape(ROWS, count, samples)
