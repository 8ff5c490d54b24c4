"""One swim frame by frame, for pictures: the midline along the rail."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from affine_model.advance import Drive
from affine_model.curvature import Array, midline
from affine_model.simulate import Timing, simulate
from affine_model.swim.trial import GaitTrial
from tentacle.waveform import Waveform


@dataclass(frozen=True)
class SwimFilm:
    """t (T,) [s]; theta (T,) [rad]; travel (T,) [m] forward; s (P,); xy (T, P, 2) [m] from the start on the rail."""

    t: Array
    theta: Array
    travel: Array
    s: Array
    xy: Array


def swim_film(
    trial: GaitTrial, motion: Waveform, seconds: float = 10.0, frames_per_second: int = 30, points: int = 31
) -> SwimFilm:
    """The trial's arm under a base motion from rest; the trial should be on a rail (Trial.on_rail)."""
    substeps = int(np.ceil(1.0 / (frames_per_second * trial.step)))
    step = 1.0 / (frames_per_second * substeps)
    middles = (np.arange(round(seconds / step)) + 0.5) * step
    arm = replace(trial.arm, nodes=max(8, trial.arm.nodes))
    base = motion(middles)[:, :, None]
    batch = simulate(arm, trial.parameters[:, :1], base, Timing(step, substeps), drive=Drive(rail=trial.rail))
    s = np.linspace(0.0, 1.0, points)
    xy = midline(batch.q[:, :, 0], batch.theta[:, 0], arm.specimen.length, s)
    xy[:, :, 1] += batch.rail
    return SwimFilm(batch.t, batch.theta[:, 0], -batch.rail[:, 0], s, xy)
