"""The motion that a recording shows, in nats: what a share of it could tell.

    nats = |w(y(u(t)) - y(mean u))|^2 / 2

y: what the recording would show of the fitted run u(t); w: whitened by noise and by a share of unknown forces
(inference.latent_force).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from inference.experiment import predict, whitened_residuals
from inference.fit import Fit
from inference.latent_force import LatentForce
from inference.trajectory import Problem


def motion_nats(problem: Problem, fitted: Fit, forces: tuple[LatentForce, ...], share: float) -> float:
    """The nats of the motion in all recordings beside this share of unknown forces."""
    known, parameters = problem.known(fitted.parameters)
    total = 0.0
    for experiment, nuisances, force in zip(known.experiments, fitted.nuisances, forces, strict=True):
        run = predict(known.arm, experiment, parameters[:, None], nuisances[:, None], known.step)
        q, theta = run.q[experiment.used], run.theta[experiment.used]
        at, turned = 0.0 * run.q + q.mean(axis=0), 0.0 * run.theta + theta.mean(axis=0)
        still = replace(run, q=at, theta=turned, motion=run.motion and run.motion.stopped())
        moved = whitened_residuals(experiment, still) - whitened_residuals(experiment, run)
        total += 0.5 * float(np.sum(force.filter(share).whiten(moved) ** 2))
    return total
