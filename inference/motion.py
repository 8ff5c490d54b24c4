"""The motion that recordings show: in nats, which is what a share of it could tell, and in noise variances.

    nats = |w(y(u(t)) - y(mean u))|^2 / 2
    power = mean of (y(u(t)) - y(mean u))^2 / sigma^2

y: what the recording would show of the fitted run u(t); w: whitened by noise and by a share of unknown forces
(inference.latent_force); sigma: of the noise alone.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from affine_model.curvature import Array
from inference.experiment import predict, whitened_residuals
from inference.fit import Fit
from inference.latent_force import LatentForce
from inference.trajectory import Problem


@dataclass(frozen=True)
class ShownMotion:
    """The nats of the motion in all recordings; its mean square [noise variances] in those that are judged, and in
    those that are declared complete (0: there is none, or it is not known).
    """

    nats: float = 0.0
    power: float = 0.0
    baseline_power: float = 0.0

    def share_of(self, residual: float) -> float:
        """The share of the motion of the judged recordings that a mean square [noise variances] of a residual is."""
        return float(np.sqrt(residual / self.power)) if self.power > 0.0 else float("inf")


NO_MOTION = ShownMotion()  # nothing is known of it


def motion_shown(problem: Problem, fitted: Fit, forces: tuple[LatentForce, ...], share: float) -> ShownMotion:
    """The motion in all recordings; its nats beside this share of unknown forces."""
    moved = _moved(problem, fitted)
    whitened = (force.filter(share).whiten(rows) for rows, force in zip(moved, forces, strict=True))
    nats = sum(0.5 * float(np.sum(rows**2)) for rows in whitened)
    used = [(e.complete, rows[e.used].ravel()) for e, rows in zip(problem.experiments, moved, strict=True)]
    judged, complete = (
        np.concatenate([np.zeros(0), *(rows[rows != 0.0] for is_complete, rows in used if is_complete == wanted)])
        for wanted in (False, True)
    )
    return ShownMotion(nats, _mean_square(judged), _mean_square(complete))


def _mean_square(rows: Array) -> float:
    return float(np.mean(rows**2)) if rows.size else 0.0


def _moved(problem: Problem, fitted: Fit) -> list[Array]:
    """How far the fitted run is from its mean, in rows (T, K, 1) of each recording, whitened by noise."""
    known, parameters = problem.known(fitted.parameters)
    found = []
    for experiment, nuisances in zip(known.experiments, fitted.nuisances, strict=True):
        run = predict(known.arm, experiment, parameters[:, None], nuisances[:, None], known.step)
        q, theta = run.q[experiment.used], run.theta[experiment.used]
        at, turned = 0.0 * run.q + q.mean(axis=0), 0.0 * run.theta + theta.mean(axis=0)
        still = replace(run, q=at, theta=turned, motion=run.motion and run.motion.stopped())
        found.append(whitened_residuals(experiment, still) - whitened_residuals(experiment, run))
    return found
