"""Named effects must explain the frames that nothing was chosen on: what is left of their error, and what follows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from discovery.decide import FORM, Missing, PosteriorDecision
from discovery.predictive_check import is_withdrawn, mass_of_else, predictive_words, unpredicted
from inference.posterior import declared_model

MISSING = Missing(share=0.1, rest=100.0, gained=500.0, left=0.1, structured=10.0, declared=0.003)


@pytest.fixture(scope="module")
def named(plain) -> PosteriorDecision:
    """A decision that names a current with .9, where something else holds .1."""
    leading = declared_model(plain.problem, plain.fitted.nuisances)
    return PosteriorDecision("effect", ("current",), 0.9, ("current",), (), {}, leading, (), 0.1)


def test_what_is_left_is_a_share_of_the_squared_error_beyond_the_floor() -> None:
    noise = 0.3
    before, after = np.hypot(noise, 4.0), np.hypot(noise, 2.0)  # errors of 4 and 2 beside the same noise
    assert unpredicted(before, after, noise) == pytest.approx(0.25)
    assert unpredicted(before, noise, noise) == 0.0
    assert unpredicted(before, np.hypot(noise, 5.0), noise) > 1.0


@pytest.mark.parametrize(("before", "after"), [(0.2, 0.3), (None, 0.3), (0.4, None)])
def test_judged_frames_without_an_error_beyond_the_floor_tell_nothing(
    before: float | None, after: float | None
) -> None:
    assert unpredicted(before, after, 0.3) == 0.0


def test_an_answer_that_predicts_within_the_form_of_laws_keeps_its_mass(named: PosteriorDecision) -> None:
    assert mass_of_else(named, MISSING, 0.0) == pytest.approx(0.1)
    kept = mass_of_else(named, MISSING, FORM**2)  # one standard deviation: k = exp(-1/2)
    assert kept == pytest.approx(0.1 / (0.1 + 0.9 * np.exp(-0.5)))
    assert not is_withdrawn(named, MISSING, FORM**2, worse=False)


def test_an_answer_that_predicts_little_is_withdrawn(named: PosteriorDecision) -> None:
    assert is_withdrawn(named, MISSING, 0.8, worse=False)
    assert mass_of_else(named, MISSING, 0.8) > 0.9
    assert "80 %" in predictive_words(("current",), 0.8, withdrawn=True)[0]


def test_a_baseline_that_its_model_follows_as_badly_withdraws_nothing(named: PosteriorDecision) -> None:
    assert not is_withdrawn(named, replace(MISSING, declared_rest=100.0), 0.8, worse=False)


def test_nothing_missing_is_not_withdrawn(named: PosteriorDecision) -> None:
    assert not is_withdrawn(replace(named, verdict="nothing_missing"), MISSING, 0.8, worse=False)


def test_effects_with_which_the_model_predicts_worse_are_withdrawn_whatever_is_left(named: PosteriorDecision) -> None:
    """Where the declared model errs by no more than the floor, no share tells it."""
    assert is_withdrawn(named, replace(MISSING, declared_rest=100.0), unpredicted(0.2, 0.5, 0.3), worse=True)
    assert "worse than without" in predictive_words(("current",), 0.0, withdrawn=True)[0]
    assert not is_withdrawn(replace(named, verdict="nothing_missing"), MISSING, 0.8, worse=True)
