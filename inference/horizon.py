"""A problem on the first part of its recordings alone: it costs less, and it has fewer valleys."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from affine_model.curvature import Array
from inference.experiment import Experiment
from inference.linearise import latent_forces
from inference.motion_time import motion_time, moved_until
from inference.trajectory import Problem

FEWEST_FRAMES = 6  # that a horizon holds
AFTERWARDS = 0.1  # s beyond the last frame that counts


def until(experiment: Experiment, end: float) -> Experiment:
    """The experiment with its frames up to that instant [s]."""
    begin = experiment.t0 if experiment.release is None else experiment.release
    count = max(int(np.searchsorted(experiment.observation.t, end)), FEWEST_FRAMES)
    count = min(count, experiment.used.size)
    return replace(
        experiment,
        observation=experiment.observation.first(count),
        used=experiment.used[:count],
        duration=min(experiment.duration, end - begin + AFTERWARDS),
    )


def period(experiment: Experiment) -> float:
    """The period [s] of a recording's motion, as far as it has one."""
    return 2.0 * np.pi * motion_time(experiment)


def whitened_early(
    problem: Problem, nuisances: tuple[Array, ...], experiments: Sequence[Experiment], share: float
) -> Problem:
    """The problem with these first parts of its recordings, whitened beside a share of unknown forces as about the run
    with these nuisances.
    """
    early = replace(problem, experiments=tuple(experiments), filters=())
    own = latent_forces(early, early.parameters, nuisances)
    return replace(early, filters=tuple(force.filter(share) for force in own))


def first_part(problem: Problem, nuisances: tuple[Array, ...], moved: float, share: float) -> Problem:
    """The problem up to the instants by which that share of each recording's motion has passed, and a period of it."""
    experiments = [
        until(one, max(moved_until(one, moved), float(one.observation.t[one.used][0]) + period(one)))
        for one in problem.experiments
    ]
    return whitened_early(problem, nuisances, experiments, share)
