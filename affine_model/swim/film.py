"""One swim frame by frame, for pictures: the midline along the rail, or with the free hull."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from affine_model.advance import Pace, advance, at_rest
from affine_model.curvature import Array, midline
from affine_model.swim.free import launched
from affine_model.swim.trial import GaitTrial
from tentacle.waveform import Waveform


@dataclass(frozen=True)
class SwimFilm:
    """t (T,) [s]; theta (T,) [rad] of the servo; travel (T,) [m] forward, afloat along the first heading; s (P,);
    xy (T, P, 2) [m] from where it started.
    """

    t: Array
    theta: Array
    travel: Array
    s: Array
    xy: Array


def swim_film(
    trial: GaitTrial, motion: Waveform, seconds: float = 10.0, frames_per_second: int = 30, points: int = 31
) -> SwimFilm:
    """The trial's arm under a base motion from rest; the trial should be on a rail or afloat."""
    substeps = int(np.ceil(1.0 / (frames_per_second * trial.step)))
    step = 1.0 / (frames_per_second * substeps)
    middles = (np.arange(round(seconds / step)) + 0.5) * step
    arm = replace(trial.arm, nodes=max(8, trial.arm.nodes))
    base = motion(middles)[:, :, None]
    start = np.zeros(1), at_rest(arm, 1, trial.drive)
    if trial.free:
        start = np.zeros(1), launched(arm, trial.drive, motion(np.zeros(1)))
    course = advance(arm, trial.drive, trial.parameters[:, :1], base, start, Pace(step, substeps))
    n, s, t = arm.order, np.linspace(0.0, 1.0, points), step * substeps * np.arange(len(course.u), dtype=np.float64)
    theta, y = course.u[:, n, 0], course.u[:, n + 1, 0]
    q = course.u[:, :n, 0] @ arm.to_monomial.T
    xy = midline(q, theta + arm.root_turn(q, 1), arm.specimen.length, s)
    xy[:, :, 1] += y[:, None]
    if trial.free:
        xy[:, :, 0] += course.u[:, n + 2]
    return SwimFilm(t, motion(t)[0] if trial.free else theta, -y, s, xy)
