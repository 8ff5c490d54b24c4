"""The errors of a recording's own fit, as the noise of trials like it: an effect is injected into the real recording.

    y*(t) = h(effects, t) + e(t),    e = y - h(none),    so that    y* = y + h(effects) - h(none)

y: measured points; h: the declared model, fitted without further effects. e holds what no simulation has: a tracker's
bias, changing light, and what the declared laws leave. It is taken as it is. e is the arm's answer to what the laws
lack, and rings as the arm does: with another sign in parts of the recording, as in a wild bootstrap, it would need
forces that nothing exerts. Source: Biwer et al. 2017, Phys. Rev. D 95, 062002 (injections into measured data).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from affine_model.curvature import Array
from inference.compare import measured_points, model_run
from inference.fit import Fit
from inference.prepare import Prepared
from inference.trajectory import Problem
from tentacle.errors import InputError


@dataclass(frozen=True)
class OwnErrors:
    """t (T,) [s] from the first frame; xy (T, P, 2) [m], 0 where nothing was seen."""

    t: Array
    xy: Array

    @property
    def rms(self) -> float:
        """Of one coordinate of one point [m]."""
        return float(np.sqrt(np.mean(self.xy**2)))

    def at(self, t: Array) -> Array:
        """Errors (F, P, 2) [m] at the times t (F,), linear between the frames."""
        flat = self.xy.reshape(self.t.size, -1)
        there = np.stack([np.interp(t, self.t, column) for column in flat.T], axis=1)
        return there.reshape(t.size, *self.xy.shape[1:])


def own_errors(prepared: Prepared, problem: Problem, fitted: Fit) -> OwnErrors:
    """The errors that a fitted model leaves in its only recording, a midline or markers; InputError for others."""
    experiment, recording = problem.experiments[0], prepared.recording
    if recording.midline is None and recording.markers is None:
        raise InputError(
            f"{recording.name} has neither a midline nor markers", field="--own-errors",
            expected="a recording whose points were measured",
        )  # fmt: skip
    s, points = measured_points(prepared)
    shown = model_run(problem, fitted, 0, s, experiment.observation.beside).points
    used, t = experiment.used, experiment.observation.t
    error = np.nan_to_num(points[used] - shown[used])
    return OwnErrors(t[used] - t[used][0], error)
