"""The next experiment settles what one run cannot: a lag of the servo and a clock's offset are the same on one sine."""

from dataclasses import replace

import numpy as np
import pytest

from discovery.answer import proposal_words
from discovery.begin import Begun
from discovery.diagnose import diagnose
from discovery.given import SERVO_UNDER_LOAD
from discovery.next_experiment import DURATION, SEPARATES, Proposal, propose_experiment
from discovery.rank import RankedSet, ranking
from discovery.refits import added
from discovery.starts import base_follows, refit_starts
from inference.marker_observation import MarkerObservation
from inference.posterior import declared_model, fit_hypothesis
from tentacle.io.waveform_file import waveform_from_table
from tentacle.waveform import Ramped, Rest, Sine


@pytest.mark.long
def test_the_proposed_motion_splits_a_lag_from_an_offset(recorded):
    hidden = {("servo_lag", "tau"): 0.012}
    sine = recorded(hidden, wave=Ramped(Sine(0.3, 1.1), 2.0), noise=1e-3)
    first = diagnose([sine])
    assert first.verdict == "group"
    assert {"servo_lag", "time_offset"} <= set(first.effects)
    place = [first.twin_names.index(name) for name in ("servo_lag", "time_offset")]
    assert abs(first.twin_cosines[place[0], place[1]]) > 0.99  # twins on one sine
    assert first.next_experiment is not None

    proposed = waveform_from_table(first.next_experiment)
    second = recorded(hidden, wave=proposed, noise=1e-3, seconds=DURATION, seed=1)
    both = diagnose([sine, second])
    assert both.verdict == "effect"
    assert both.effects == ("servo_lag",)
    estimate = both.parameters["servo_lag"]["tau"]
    sigma = (estimate.high - estimate.low) / (2 * 1.96)
    assert abs(estimate.value - 0.012) < 4.0 * sigma  # one noise in 16 000 is further off
    assert estimate.high - estimate.low < 0.002


@pytest.fixture(scope="module")
def without_and_with(with_current):
    """The declared model of a recording with a current, and the same with the current added."""
    smaller = declared_model(with_current.problem, with_current.fitted.nuisances)
    (candidate,) = (c for c in ranking(smaller, 1).candidates if c.effect.name == "current")
    chosen = RankedSet((candidate,), 0.0, (candidate.strengths,))
    starts = refit_starts(smaller, chosen, base_follows(smaller, smaller))
    return smaller, fit_hypothesis(added(smaller, Begun(chosen, (), tuple(starts))), smaller.forces)


def test_a_model_that_contains_the_other_one_is_separated_from_it_too(without_and_with):
    """It follows each run of the smaller model exactly: only its own runs show the difference."""
    smaller, larger = without_and_with
    proposal = propose_experiment(smaller, (larger,), SERVO_UNDER_LOAD, 0)
    assert proposal is not None
    assert proposal.sets == ((), ("current",))
    assert proposal.nats > SEPARATES
    assert proposal.asked is not None


def _seen_as(h, observation, **changed):
    (experiment,) = h.problem.experiments
    return replace(h, problem=replace(h.problem, experiments=(replace(experiment.seeing(observation), **changed),)))


def test_markers_are_proposed_a_motion_too(without_and_with):
    (experiment,) = without_and_with[0].problem.experiments
    seen, nats = experiment.observation, {}
    for sigma in (1e-4, 2e-4):
        s, d = np.array([0.4, 0.7, 1.0]), np.zeros(3)
        markers = MarkerObservation(seen.t, seen.theta, seen.length, s, d, np.zeros((seen.t.size, 3, 2)), sigma)
        smaller, larger = (_seen_as(h, markers) for h in without_and_with)
        proposal = propose_experiment(smaller, (larger,), SERVO_UNDER_LOAD, 0)
        assert proposal is not None
        assert proposal.asked is not None
        nats[sigma] = proposal.nats
    # Half the squares of differences in noise deviations: four times as many with half the noise. The priors of the
    # initial state are not divided by the noise, and bend this by some per cent.
    assert nats[1e-4] / nats[2e-4] == pytest.approx(4.0, rel=0.1)


def test_no_motion_is_proposed_where_no_servo_turned_the_base(without_and_with):
    (experiment,) = without_and_with[0].problem.experiments
    for still in ({"base": Rest()}, {"release": 0.0}):
        smaller, larger = (_seen_as(h, experiment.observation, **still) for h in without_and_with)
        assert propose_experiment(smaller, (larger,), SERVO_UNDER_LOAD, 0) is None


def test_a_motion_that_separates_nothing_is_not_proposed_and_its_words_say_so():
    idle = Proposal(Sine(0.3, 1.1), (("camera_scale",), ()), 0.9 * SEPARATES)
    assert idle.asked is None
    assert proposal_words(idle).startswith("No base motion")
    assert "camera_scale from nothing missing:" in proposal_words(idle)


def test_the_words_say_from_what_the_effects_are_separated_and_for_how_long():
    useful = Proposal(Sine(0.3, 1.1), (("soft_spot",), (), ("wall", "current")), 31.0)
    words = proposal_words(useful)
    assert f"{DURATION:.0f} s of the base motion" in words
    assert "separate soft_spot from nothing missing and from wall + current by at least 31 nats" in words
