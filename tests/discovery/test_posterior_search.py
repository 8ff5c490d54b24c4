"""Sets ranked by linear algebra, and the search from end to end, on recordings whose truth is in the model."""

import numpy as np
import pytest

from discovery.decide import decide_by_mass, missing_of
from discovery.detection import detection_limits
from discovery.rank import ranked_sets, ranking
from discovery.search import search_posterior
from inference.estimates import interval
from inference.posterior import declared_model
from inference.score import responses, score
from inference.whitened_fit import whitened_fit


@pytest.fixture(scope="module")
def base_with_current(with_current):
    return declared_model(with_current.problem, with_current.fitted.nuisances)


@pytest.fixture(scope="module")
def found(base_with_current):
    return search_posterior(base_with_current, base_with_current.fitted)


def test_a_set_s_first_order_strengths_are_the_least_squares_ones(base_with_current):
    white = whitened_fit(base_with_current.problem, base_with_current.fitted)
    candidates = score(white, responses(base_with_current.problem, base_with_current.fitted))
    ranked = {one.names: one for one in ranked_sets(white, candidates, 2)}
    single = max((one for one in ranked.values() if len(one.names) == 1), key=lambda one: one.evidence)
    assert single.names == ("current",)
    np.testing.assert_allclose(single.strengths[0], single.candidates[0].strengths, rtol=1e-3, atol=1e-6)
    # A pair explains no less than either of its members alone, and pays for its freedom.
    pair = max((one for one in ranked.values() if len(one.names) == 2), key=lambda one: one.evidence)
    assert "current" in pair.names


def test_a_hidden_current_is_named_and_measured(found):
    decision = decide_by_mass(list(found.hypotheses))
    assert decision.certain == ("current",) or decision.effects == ("current",)
    low, high = interval(decision.leading.problem, decision.leading.fitted, ("current", "U_x"))
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    # A 95 % interval, taken twice as wide: it holds the truth with a chance of 0.9999.
    assert abs(middle - 0.03) < 2.0 * half
    assert decision.leading.share < found.base.share


def test_nothing_hidden_nothing_named_and_the_limits_say_what_that_excludes(plain):
    base = declared_model(plain.problem, plain.fitted.nuisances)
    hypotheses = list(search_posterior(base, base.fitted).hypotheses)
    decision = decide_by_mass(hypotheses)
    assert decision.verdict == "nothing_missing"
    limits = detection_limits(decision.leading, missing_of(hypotheses).temperature)
    # The current of 30 mm/s that the other recording hides would have been named in this one.
    assert 0.0 < limits["current"]["U_x"].value < 0.03


def test_beside_a_smaller_share_of_unknown_forces_an_effect_promises_more(base_with_current):
    """The base needs unknown forces in the current's place; a refit with the current needs none."""
    base, white = base_with_current, whitened_fit(base_with_current.problem, base_with_current.fitted)
    known = responses(base.problem, base.fitted)
    there = {one.names: one.evidence for one in ranked_sets(white, score(white, known), 1)}
    promised = {one.names: one.evidence for one in ranking(base, 1).sets}
    assert base.share > 0.001
    assert promised["current",] > there["current",]
    assert all(promised[name] >= there[name] - 1e-6 for name in there)
