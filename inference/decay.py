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

from affine_model.curvature import Array
from inference.fit import minimised, split
from inference.horizon import period, until, whitened_early
from inference.successive_halving import Leg
from inference.trajectory import Problem

HORIZONS, STEPS = (1.0, 2.5, 6.0), 3  # periods of the motion that are followed one after the other; steps on each
HALF = 0.5  # of the points go on from one horizon to the next
DECAY_SHARE = 0.05  # of unknown forces, beside which the fits of a decay begin
ROUGH_TOLERANCE, MOST_ROUNDS = 1e-3, 20  # of the fits on the way


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
    """The problem with the first periods of its decays alone, whitened as about the run with these nuisances. A
    recording that does not decay is whole.
    """
    experiments = [
        one if one.release is None else until(one, one.release + periods * period(one)) for one in problem.experiments
    ]
    return whitened_early(problem, nuisances, experiments, DECAY_SHARE)
