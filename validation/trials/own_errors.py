"""The errors of a recording's own fit, as the noise of trials like it: the dependent wild bootstrap.

    e*(t) = e(t) w(t),    w(t) = sin(pi/2 tanh(STEEP g(t))),    g Gaussian, cov(g(t), g(t')) = exp(-(t - t')^2 / 2 T^2)

e: measured points minus those of the declared model, fitted without further effects. It holds what no simulation has: a
tracker's bias, changing light, and what the declared laws leave. w is a sign that turns now and then, smoothly: e* is
as large as e, but no two trials have the same. It turns seldom, because e is the arm's answer to what the laws lack,
and rings as the arm does: a sign that turned within a few swings would need forces that nothing exerts. Sources: Shao
2010 (dependent), Davidson and Flachaire 2008 (signs alone).
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

BLOCK = 0.2  # of the recording: T
STEEP = 4.0  # |w| is over .9 in four instants of five
WAVES = 400  # random frequencies, of which g is the sum: its variance is right to 1 / sqrt(400)


@dataclass(frozen=True)
class OwnErrors:
    """t (T,) [s] from the first frame; xy (T, P, 2) [m], 0 where nothing was seen; time [s]: T."""

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
        g = np.sqrt(2.0 / WAVES) * np.cos(t[:, None] * frequency + phase).sum(axis=1)
        w = np.sin(0.5 * np.pi * np.tanh(STEEP * g))
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
