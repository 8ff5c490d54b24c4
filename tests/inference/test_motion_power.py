"""The power of the motion that a recording shows, in noise variances."""

from dataclasses import replace

import numpy as np
import pytest

from discovery.baseline_law import BaselineError
from discovery.decide import DECLARED_FORM
from inference.linearise import latent_forces
from inference.motion import ShownMotion, motion_shown
from inference.posterior import FORCE_SHARES, Hypothesis


def with_noise(problem, gain: float):
    """The problem with so many times the noise."""
    experiments = tuple(replace(e, noise_gain=gain * e.noise_gain) for e in problem.experiments)
    return replace(problem, experiments=experiments)


def shown(problem, fitted) -> ShownMotion:
    """The motion, its nats beside the smallest share of unknown forces."""
    forces = latent_forces(problem, fitted.parameters, fitted.nuisances)
    return motion_shown(problem, fitted, forces, FORCE_SHARES[0])


def test_twice_the_noise_is_a_quarter_of_the_power(plain):
    power = shown(plain.problem, plain.fitted).power
    assert power > 100.0  # the arm swings by many times its noise
    assert shown(with_noise(plain.problem, 2.0), plain.fitted).power == pytest.approx(0.25 * power)


def test_a_residual_of_a_hundredth_of_the_motion_is_that_share_of_it(plain):
    motion = shown(plain.problem, plain.fitted)
    assert motion.share_of(1e-4 * motion.power) == pytest.approx(0.01)
    assert ShownMotion().share_of(1.0) == np.inf  # nothing is known of the motion


def test_only_the_recordings_that_are_asked_for_count(plain):
    assert shown(plain.problem, plain.fitted).baseline_power == 0.0


def test_a_baseline_with_a_quarter_of_the_power_lets_expect_four_times_its_rest(plain):
    """The same run is declared complete in a second recording, whose noise is twice as large."""
    judged, (own,) = plain.problem, plain.fitted.nuisances
    complete = tuple(replace(e, complete=True) for e in with_noise(judged, 2.0).experiments)
    both = replace(judged, experiments=(*judged.experiments, *complete))
    twice = replace(plain.fitted, nuisances=(own, own))
    base = Hypothesis((), both, twice, (), np.zeros(len(FORCE_SHARES)), motion=shown(both, twice))
    least = DECLARED_FORM**2 * shown(judged, plain.fitted).power
    assert BaselineError(0.01, 3.0 * least, 1.0, 0.0, 0.0).told(base).baseline_rest == pytest.approx(12.0 * least)
    # Where the baseline is followed exactly, the laws may still err by as much as any.
    assert BaselineError(0.01, 0.0, 1.0, 0.0, 0.0).told(base).baseline_rest == pytest.approx(least)
