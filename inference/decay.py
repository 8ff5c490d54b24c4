"""Where the fit of a free decay begins: a horizon that grows.

    minimise  |w(unknowns; t < t_release + k periods)|^2 / 2     for k in HORIZONS, each from where the last one ended

A decay's phase runs away with any error of the frequency: over the whole recording the sum of squares has a valley for
every cycle that is gained or lost, and a broad one where the motion is damped to nothing. Over its first period it has
one. w: residuals whitened beside a share DECAY_SHARE of unknown forces (inference.latent_force).

Voss, Timmer and Kurths 2004 describe these valleys and the methods that fit short pieces first; a horizon that grows is
the plainest of them, for a run that begins at a known release.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from affine_model.curvature import Array
from inference.experiment import Experiment
from inference.fit import minimised, split
from inference.latent_force import ELL
from inference.linearise import latent_forces
from inference.motion_time import motion_time
from inference.successive_halving import Leg
from inference.trajectory import Problem

HORIZONS, STEPS = (1.0, 2.5, 6.0), 3  # periods of the motion that are followed one after the other; steps on each
HALF = 0.5  # of the points go on from one horizon to the next
DECAY_SHARE = 0.05  # of unknown forces, beside which the fits of a decay begin
ROUGH_TOLERANCE, MOST_ROUNDS = 1e-3, 20  # of the fits on the way
FEWEST_FRAMES = 6  # that a horizon holds
AFTERWARDS = 0.1  # s beyond the last frame that counts


def has_decay(problem: Problem) -> bool:
    """Whether a recording among them is a free decay."""
    return any(experiment.release is not None for experiment in problem.experiments)


def fit_from_release(problem: Problem, nuisances: tuple[Array, ...]) -> tuple[Problem, tuple[Array, ...]]:
    """A problem with decays fitted at one horizon after the other, each about the fit before."""
    for periods in HORIZONS:
        early = horizon_of(problem, nuisances, periods)
        unknowns, _ = minimised(early, nuisances, tolerance=ROUGH_TOLERANCE, most=MOST_ROUNDS)
        parameters, nuisances = split(problem, unknowns)
        problem = replace(problem, parameters=parameters)
    return problem, nuisances


def horizons_of(problem: Problem, nuisances: tuple[Array, ...]) -> tuple[Leg, ...]:
    """The legs of successive halving along HORIZONS, whitened as about the run with these nuisances. The declared
    numbers move on the last leg alone, on which the fewest points are left.
    """
    early, last = HORIZONS[:-1], HORIZONS[-1]
    legs = [Leg(horizon_of(problem, nuisances, periods), STEPS, HALF, declared=False) for periods in early]
    return (*legs, Leg(horizon_of(problem, nuisances, last), STEPS, HALF))


def horizon_of(problem: Problem, nuisances: tuple[Array, ...], periods: float) -> Problem:
    """The problem with the first periods of its decays alone, whitened as about the run with these nuisances."""
    experiments = tuple(
        _until(experiment, 2.0 * np.pi * periods * ELL * motion_time(experiment)) for experiment in problem.experiments
    )
    early = replace(problem, experiments=experiments, filters=())
    own = latent_forces(early, early.parameters, nuisances)
    return replace(early, filters=tuple(force.filter(DECAY_SHARE) for force in own))


def _until(experiment: Experiment, after: float) -> Experiment:
    """The experiment with the frames up to that long after its release [s]; one that does not decay is as it was."""
    if experiment.release is None:
        return experiment
    count = max(int(np.searchsorted(experiment.observation.t, experiment.release + after)), FEWEST_FRAMES)
    count = min(count, experiment.used.size)
    return replace(
        experiment,
        observation=experiment.observation.first(count),
        used=experiment.used[:count],
        duration=min(experiment.duration, after + AFTERWARDS),
    )
