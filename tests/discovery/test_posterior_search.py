"""Sets ranked by linear algebra, and the search from end to end, on recordings whose truth is in the model."""

from dataclasses import replace

import numpy as np
import pytest

from affine_model.arm import parameter_index
from discovery.begin import Begun, begun_about
from discovery.decide import decide_by_mass, missing_of
from discovery.detection import detection_limits
from discovery.nested import nested_pairs, nested_refit, stands_in_another_valley
from discovery.rank import RankedSet, ranked_sets, ranking
from discovery.refits import added
from discovery.search import FAR, is_fitted_anew, search_posterior
from discovery.starts import base_follows, is_far, refit_starts
from inference.estimates import interval
from inference.posterior import declared_model, fit_hypothesis
from inference.score import responses, score
from inference.whitened_fit import whitened_fit
from tests.made_recordings import SPECIMEN, base_of


@pytest.fixture(scope="module")
def base_with_current(with_current):
    return declared_model(with_current.problem, with_current.fitted.nuisances)


@pytest.fixture(scope="module")
def found(base_with_current):
    return search_posterior(base_with_current, base_with_current.fitted)


def test_a_payload_as_heavy_as_the_arm_is_found_beside_a_base_that_is_far_off(recorded):
    """Without it the modulus is bent to a fraction of the truth: no first step leads back from there."""
    payload = SPECIMEN.mass
    alone = base_of(recorded({("tip_mass", "mass"): payload}))
    base = declared_model(alone.problem, alone.fitted.nuisances)
    assert is_far(base)
    (candidate,) = (c for c in ranking(base, 1).candidates if c.effect.name == "tip_mass")
    chosen = RankedSet((candidate,), 0.0, (candidate.strengths,))
    starts = refit_starts(base, chosen, base_follows(base, base))
    close = fit_hypothesis(added(base, Begun(chosen, (), tuple(starts))), base.forces)
    mass = close.fitted.parameters[parameter_index("tip_mass", "mass")]
    low, high = interval(close.problem, close.fitted, ("tip_mass", "mass"))
    # A 95 % interval, taken twice as wide, as above.
    assert abs(mass - payload) < high - low
    assert high - low < 0.1 * payload


def test_a_current_is_found_beside_a_base_that_stands_at_its_bound(recorded):
    """It bends the arm so far that the base has no drag, and a fortieth of the modulus: no current acts there."""
    hidden = {("current", "U_x"): -0.36, ("current", "U_y"): -0.09}
    alone = base_of(recorded(hidden))
    base = declared_model(alone.problem, alone.fitted.nuisances)
    promised = ranking(base, 1)
    assert ("drag", "C_perp") in base.fitted.at_bound
    assert "current" not in {one.effect.name for one in promised.candidates}
    (begun,) = (one for one in begun_about(base, promised, base, 1.0) if one.chosen.names == ("current",))
    close = fit_hypothesis(added(base, begun), base.forces)
    for name, truth in hidden.items():
        low, high = interval(close.problem, close.fitted, name)
        # A 95 % interval, taken twice as wide, as above.
        assert abs(close.fitted.parameters[parameter_index(*name)] - truth) < high - low < 0.1 * abs(truth)


@pytest.mark.long
def test_added_mass_is_found_although_no_start_lies_in_its_valley(recorded):
    """Water that moves with the arm halves the fitted modulus. To first order the whole base scales back, but every
    start on that line leaves more than the base does: the motion holds 1e7 nats.
    """
    alone = base_of(recorded({("added_mass", "C_a"): 1.0, ("added_mass", "convective"): 0.0}, seconds=12.0))
    base = declared_model(alone.problem, alone.fitted.nuisances)
    assert base.fitted.parameters[parameter_index("elasticity", "E")] < 0.6 * 2e5
    found = {h.effects: h for h in search_posterior(base, base.fitted).hypotheses}
    own, twin = found[("added_mass",)], found[("buoyancy",)]
    assert own.log_evidence.max() > twin.log_evidence.max()
    low, high = interval(own.problem, own.fitted, ("added_mass", "C_a"))
    # A 95 % interval, taken twice as wide.
    assert abs(own.fitted.parameters[parameter_index("added_mass", "C_a")] - 1.0) < high - low


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


def test_two_standing_waves_are_found_from_both_of_their_lines(recorded):
    """The second wave of the two is the stronger line. The score's frequency is the first one's all the same."""
    waves = {("sloshing", "f"): 0.9, ("sloshing", "U_sin"): 0.008, ("sloshing", "V_cos"): 0.02}
    base = base_of(recorded(waves))
    white = whitened_fit(base.problem, base.fitted)
    (candidate,) = (c for c in score(white, responses(base.problem, base.fitted)) if c.effect.name == "sloshing")
    # The scan has steps of .1 Hz, and the residual's peaks add their own frequencies to it.
    assert abs(candidate.shapes[0] - 0.9) < 0.05
    strengths = dict(zip((p.name for p in candidate.effect.strengths), candidate.strengths, strict=True))
    assert strengths["V_cos"] == pytest.approx(0.02, rel=0.2)


def test_a_set_that_explains_less_than_its_subset_is_fitted_anew(found):
    single = next(h for h in found.hypotheses if h.effects == ("current",))
    pair = ("current", "wall")
    worse, better = (replace(single, effects=pair, log_evidence=single.log_evidence + shift) for shift in (-1e3, 5.0))
    assert is_fitted_anew(pair, single, {})
    assert is_fitted_anew(pair, single, {frozenset(pair): worse})
    assert not is_fitted_anew(pair, single, {frozenset(pair): better})


def test_a_subset_in_another_valley_begins_again_where_a_larger_set_stands(found):
    single = next(h for h in found.hypotheses if h.effects == ("current",))
    lost = single.fitted.parameters.copy()
    lost[parameter_index("current", "U_x")] *= -20.0
    astray = replace(single, fitted=replace(single.fitted, parameters=lost), log_evidence=single.log_evidence - 500.0)
    pair = replace(single, effects=("current", "wall"), log_evidence=single.log_evidence + 3.0)
    tried = {frozenset(h.effects): h for h in (astray, pair)}
    pairs = nested_pairs(tried, FAR)
    assert pairs == [(frozenset({"current"}), frozenset({"current", "wall"}))]
    rough = nested_refit(tried, pairs[0])()
    assert rough.effects == ("current",)
    assert stands_in_another_valley(astray, rough, FAR)
    assert not stands_in_another_valley(single, rough, FAR)
    assert not nested_pairs(tried | {frozenset(single.effects): single}, FAR)
