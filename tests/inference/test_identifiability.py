"""What the data can tell: condition, dead channels, the clock; and the bootstrap beside the covariance."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binom

from affine_model.arm import Arm, neutral_parameters, parameter_index
from affine_model.base_signal import step_middles
from affine_model.simulate import Timing, simulate
from inference.appearance import Appearance
from inference.bootstrap import bootstrap
from inference.experiment import Experiment
from inference.fit import fit
from inference.identifiability import identifiability
from inference.marker_observation import MarkerObservation
from inference.trajectory import Problem
from tentacle.specimen import WATER, Cone, Gravity, Specimen
from tentacle.waveform import Chirp

ARM = Arm(Specimen(Cone(0.0125, 0.004), 0.14, 1070.0), WATER, Gravity())
WAVE = Chirp(0.5, 0.3, 2.0, 4.0)
FREE = (("elasticity", "E"), ("damping", "eta"), ("drag", "C_perp"))
VALUES = (1.6e5, 1.5e3, 1.1)
SIGMA, STEP = 2e-4, 1 / 400
DELAY = 0.004  # s: how late the camera's clock is in the delayed recording


def problem_of(delay, seed=5):
    """Three markers, the middle one never seen; frames every 25 ms."""
    p = neutral_parameters()
    for name, value in zip(FREE, VALUES, strict=True):
        p[parameter_index(*name)] = value
    batch = simulate(ARM, p[:, None], WAVE(step_middles(0.0, STEP, 1600))[:, :, None], Timing(STEP, 10))
    s, d = np.array([0.5, 0.8, 1.0]), np.zeros(3)
    blind = MarkerObservation(batch.t, batch.theta[:, 0], 0.14, s, d, np.zeros((batch.t.size, 3, 2)), 1.0)
    shape = -blind.predict(Appearance.as_declared(batch.q, batch.theta))[:, :, 0]
    xy = shape.reshape(-1, 3, 2) + SIGMA * np.random.default_rng(seed).standard_normal((batch.t.size, 3, 2))
    xy[:, 1] = np.nan
    seen = replace(blind, t=batch.t - delay, xy=xy, sigma=SIGMA)
    used = batch.t > 2 * DELAY
    experiment = Experiment("run", seen, WAVE, 0.0, 4.0, None, used, np.ones(6))
    return Problem(ARM, (experiment,), FREE, p, STEP), (np.zeros(4),)  # two shapes, two rates


@pytest.fixture(scope="module")
def fitted():
    problem, nuisances = problem_of(0.0)
    return problem, fit(problem, nuisances)


def test_a_channel_that_was_never_seen_is_named(fitted):
    assert identifiability(*fitted).dead == ((2, 3),)


def test_the_condition_is_that_of_the_correlations(fitted):
    known = identifiability(*fitted)
    spread = np.sqrt(np.diag(fitted[1].covariance))
    assert known.condition == pytest.approx(np.linalg.cond(fitted[1].covariance / np.outer(spread, spread)))
    assert np.linalg.norm(known.weakest) == pytest.approx(1.0)


def test_a_clock_that_is_right_shows_no_offset_and_a_late_one_its_delay(fitted):
    offset, sigma = identifiability(*fitted).clock
    assert abs(offset) < 4.0 * sigma
    assert sigma < 0.5 * DELAY
    problem, nuisances = problem_of(DELAY)
    offset, sigma = identifiability(problem, fit(problem, nuisances)).clock
    # To first order: the fit has bent E by some per cent before it is asked, hence the tenth.
    assert offset == pytest.approx(DELAY, abs=0.1 * DELAY + 4.0 * sigma)
    assert offset > 6.0 * sigma


def test_intervals_of_95_per_cent_hold_the_truth_in_95_of_100():
    count, inside = 60, np.zeros(3)
    for seed in range(count):
        problem, nuisances = problem_of(0.0, seed)
        found = fit(problem, nuisances)
        inside += np.abs(found.values - VALUES) < 1.96 * np.sqrt(np.diag(found.covariance))
    # The count of hits is binomial: outside these limits once in 2000 for each parameter, were the coverage .95.
    fewest, most = binom.ppf([0.00025, 0.99975], count, 0.95)
    assert np.all((inside >= fewest) & (inside <= most))


def test_bootstrap_intervals_are_as_wide_as_the_covariance_says(fitted):
    problem, found = fitted
    drawn = bootstrap(problem, found, replicates=200, seed=1)
    spread = np.sqrt(np.diag(found.covariance))
    # White noise: both tell the same. 200 draws know a standard deviation to 5 %, a 2.5 % tail to 15 %; 40 frames a
    # block leave 4 blocks, whose means are removed: 10 % more.
    assert np.all(np.abs(drawn.values.std(axis=1) / spread - 1.0) < 0.35)
    again = bootstrap(problem, found, replicates=200, seed=1)
    assert np.array_equal(drawn.low, again.low)
    with pytest.raises(ValueError, match="at least 20"):
        bootstrap(problem, found, replicates=3)
