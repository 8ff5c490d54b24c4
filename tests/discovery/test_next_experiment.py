"""The next experiment settles what one run cannot: a lag of the servo and a clock's offset are the same on one sine."""

import pytest

from discovery.answer import proposal_words
from discovery.begin import Begun
from discovery.diagnose import diagnose
from discovery.given import SERVO_UNDER_LOAD
from discovery.next_experiment import DURATION, SEPARATES, Proposal, propose_experiment
from discovery.rank import RankedSet, ranking
from discovery.refits import added
from discovery.starts import base_follows, refit_starts
from inference.posterior import declared_model, fit_hypothesis
from tentacle.io.waveform_file import waveform_from_table
from tentacle.waveform import Ramped, Sine


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


def test_a_model_that_contains_the_other_one_is_separated_from_it_too(with_current):
    """It follows each run of the smaller model exactly: only its own runs show the difference."""
    smaller = declared_model(with_current.problem, with_current.fitted.nuisances)
    (candidate,) = (c for c in ranking(smaller, 1).candidates if c.effect.name == "current")
    chosen = RankedSet((candidate,), 0.0, (candidate.strengths,))
    starts = refit_starts(smaller, chosen, base_follows(smaller, smaller))
    larger = fit_hypothesis(added(smaller, Begun(chosen, (), tuple(starts))), smaller.forces)
    proposal = propose_experiment(smaller, (larger,), SERVO_UNDER_LOAD, 0)
    assert proposal is not None
    assert proposal.sets == ((), ("current",))
    assert proposal.nats > SEPARATES
    assert proposal.asked is not None


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
