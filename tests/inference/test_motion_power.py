"""The power of the motion that a recording shows, in noise variances."""

from dataclasses import replace

import numpy as np
import pytest

from discovery.baseline_law import BaselineError
from discovery.decide import DECLARED_FORM
from inference.motion import motion_powers
from inference.posterior import FORCE_SHARES, Hypothesis


def with_noise(problem, gain: float):
    """The problem with so many times the noise."""
    experiments = tuple(replace(e, noise_gain=gain * e.noise_gain) for e in problem.experiments)
    return replace(problem, experiments=experiments)


def test_twice_the_noise_is_a_quarter_of_the_power(plain):
    power, _ = motion_powers(plain.problem, plain.fitted)
    assert power > 100.0  # the arm swings by many times its noise
    assert motion_powers(with_noise(plain.problem, 2.0), plain.fitted)[0] == pytest.approx(0.25 * power)


def test_only_the_recordings_that_are_asked_for_count(plain):
    assert motion_powers(plain.problem, plain.fitted)[1] == 0.0


def test_a_baseline_with_a_quarter_of_the_power_lets_expect_four_times_its_rest(plain):
    """The same run is declared complete in a second recording, whose noise is twice as large."""
    judged, (own,) = plain.problem, plain.fitted.nuisances
    complete = tuple(replace(e, complete=True) for e in with_noise(judged, 2.0).experiments)
    both = replace(judged, experiments=(*judged.experiments, *complete))
    base = Hypothesis((), both, replace(plain.fitted, nuisances=(own, own)), (), np.zeros(len(FORCE_SHARES)))
    least = DECLARED_FORM**2 * motion_powers(judged, plain.fitted)[0]
    assert BaselineError(0.01, 3.0 * least, 1.0, 0.0, 0.0).told(base).baseline_rest == pytest.approx(12.0 * least)
    # Where the baseline is followed exactly, the laws may still err by as much as any.
    assert BaselineError(0.01, 0.0, 1.0, 0.0, 0.0).told(base).baseline_rest == pytest.approx(least)
