"""The errors of a recording's own fit, as the noise of trials like it: the dependent wild bootstrap.

    e*(t) = e(t) w(t),       w Gaussian of mean 0 and variance 1, cov(w(t), w(t')) = exp(-(t - t')^2 / 2 time^2)

e: measured points minus those of the declared model, fitted without further effects. It holds what no simulation has: a
tracker's bias, changing light, and what the declared laws leave. It grows and shrinks with the motion, and so does e*;
but its sign and size vary slowly, so that no two trials have the same. Slowly, because e is the arm's answer to what
the laws lack, and rings as the arm does: a sign that turned within a few swings would need forces that nothing exerts.
Source: Shao 2010.
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

BLOCK = 0.2  # of the recording: over which w is correlated
WAVES = 400  # random frequencies, of which w is the sum: its variance is right to 1 / sqrt(400)


@dataclass(frozen=True)
class OwnErrors:
    """t (T,) [s] from the first frame; xy (T, P, 2) [m], 0 where nothing was seen; time [s] of the correlation of w."""

    t: Array
    xy: Array
    time: float

    @property
    def rms(self) -> float:
        """Of one coordinate of one point [m]."""
        return float(np.sqrt(np.mean(self.xy**2)))

    def drawn(self, t: Array, random: np.random.Generator) -> Array:
        """Errors (F, P, 2) [m] at the times t (F,)."""
        frequency = random.standard_normal(WAVES) / self.time
        phase = random.uniform(0.0, 2.0 * np.pi, WAVES)
        w = np.sqrt(2.0 / WAVES) * np.cos(t[:, None] * frequency + phase).sum(axis=1)
        flat = self.xy.reshape(self.t.size, -1)
        there = np.stack([np.interp(t, self.t, column) for column in flat.T], axis=1)
        return (w[:, None] * there).reshape(t.size, *self.xy.shape[1:])


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
    return OwnErrors(t[used] - t[used][0], error, BLOCK * float(np.ptp(t[used])))
