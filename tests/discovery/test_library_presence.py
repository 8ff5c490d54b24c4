"""In which recordings of a library an effect acts: what the estimates alone decide."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import norm

from discovery.library.joint import FALSE_CLAIMS, claims
from discovery.library.presence import Estimates, presence

COUNT = 200


def estimates(acts, strength, *, coarsening=1.0, seed=0, offset=0.0):
    """Estimates with unit deviations, of an effect of that strength where it acts."""
    random = np.random.default_rng(seed)
    values = offset + strength * acts + random.standard_normal(acts.size)
    return Estimates(values, np.ones(acts.size), np.full(acts.size, coarsening), 5.0, False)


def in_a_row():
    acts = np.zeros(COUNT, dtype=bool)
    acts[120:140] = True
    return acts


def f1(probability, acts):
    claimed = probability > 0.5
    return 2.0 * (claimed & acts).sum() / (claimed.sum() + acts.sum())


def test_twenty_in_a_row_are_found_though_no_single_one_shows_it():
    """At 1.5 deviations each the best threshold on single estimates has an F1 of .48; together they show the run.

    The two ends are blurred: at this ratio a recording tells 1.1 nats, and 3 recordings tell what begins a run (a run
    begins by chance in one of about 200 places: 5 nats). Three wrong at each end are F1 = .85.
    """
    level = np.linspace(-2.0, 5.0, 500)
    hit, false = 0.1 * norm.sf(level - 1.5), 0.9 * norm.sf(level)
    assert np.max(2.0 * hit / (hit + false + 0.1)) < 0.5
    found = [presence(estimates(in_a_row(), 1.5, seed=seed)) for seed in range(6)]
    assert np.median([f1(one.acts, in_a_row()) for one in found]) > 0.85
    assert np.median([one.strength for one in found]) == pytest.approx(1.5, abs=2.0 / np.sqrt(20.0))
    assert all(one.evidence > 0.0 for one in found)


def test_scattered_recordings_are_found_as_well_as_a_threshold_that_knows_the_strength_can():
    acts = np.zeros(COUNT, dtype=bool)
    acts[np.random.default_rng(1).choice(COUNT, 20, replace=False)] = True
    scores = [f1(presence(estimates(acts, 4.5, seed=seed)).acts, acts) for seed in range(6)]
    # The best threshold has .971; the standard deviation of one F1 is .03 (one recording of 20 more or less), so that
    # the mean of six is good to .012.
    assert np.mean(scores) > 0.971 - 3.0 * 0.012


def test_nothing_is_found_where_nothing_acts():
    found = [presence(estimates(np.zeros(COUNT, dtype=bool), 0.0, seed=seed)) for seed in range(10)]
    # A ratio of evidences of 20, exp(3), arises by chance in one of 20 nulls at most (Markov's inequality): two of ten
    # have a chance of 9 % at most.
    assert sum(one.evidence > 3.0 for one in found) <= 1
    # At even odds that it acts somewhere, it acts nowhere.
    assert np.mean([one.acts.mean() / (1.0 + np.exp(-one.evidence)) for one in found]) < 0.05


def test_an_error_of_the_model_that_all_recordings_share_is_no_effect():
    """The offset is 1.7 deviations of one recording: 24 standard deviations of the mean of 200."""
    alike = estimates(np.zeros(COUNT, dtype=bool), 0.0, coarsening=4.0, offset=np.sqrt(3.0))
    assert presence(alike).evidence < 0.0
    known = presence(estimates(np.zeros(COUNT, dtype=bool), 0.0, coarsening=1.0, offset=np.sqrt(3.0)))
    assert known.evidence > 50.0  # a model without error: the same estimates are an effect in all
    beside = presence(estimates(in_a_row(), 3.0, coarsening=4.0, offset=np.sqrt(3.0)))
    assert f1(beside.acts, in_a_row()) > 0.9


def test_a_recording_that_shows_nothing_changes_nothing_and_follows_its_neighbours():
    one = estimates(in_a_row(), 4.0)
    blind = one.deviations.copy()
    blind[130], blind[10] = np.inf, np.inf
    found = presence(Estimates(one.values, blind, one.coarsening, one.nominal, one.one_sided))
    assert found.acts[130] > 0.9
    assert found.acts[10] < 0.1
    without = np.delete(np.arange(COUNT), [10, 130])
    assert found.evidence < presence(one).evidence
    again = presence(
        Estimates(one.values[without], one.deviations[without], one.coarsening[without], one.nominal, one.one_sided)
    )
    assert found.evidence == pytest.approx(again.evidence, abs=0.5)


def test_a_strength_with_a_sign_is_not_found_with_the_other():
    one = estimates(in_a_row(), -4.0)
    signed = Estimates(one.values, one.deviations, one.coarsening, one.nominal, True)
    assert presence(one).evidence > 50.0
    assert presence(signed).evidence < 5.0


def test_claims_hold_their_expected_share_of_false_ones():
    random = np.random.default_rng(0)
    acts = random.beta(0.3, 0.5, size=(2, 5000))
    truth = random.uniform(size=acts.shape) < acts
    claimed, share = claims(list(acts))
    false = np.mean(~truth[np.array(claimed)])
    assert share <= FALSE_CLAIMS
    # Some 1500 claims of which 5 % are false: a standard deviation of .006.
    assert false == pytest.approx(share, abs=0.02)
    assert claims([]) == ([], 0.0)
    assert not np.any(claims([np.full(10, 0.4)])[0])
