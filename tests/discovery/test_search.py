"""Gates, search, verdict and next experiment on recordings whose truth is in the model."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from discovery.next_experiment import _gap, candidates, propose_experiment
from discovery.rules.refit import refit, removed_without_refit, without
from discovery.rules.search import CLEARED, _best_of_each, stepwise_search
from discovery.rules.verdict import decide_by_rules, probabilities, structure_share
from inference.adequacy import ljung_box
from inference.compare import unexplained_share
from inference.hypothesis import gated_hypothesis, material_gain, parameter_interval, variance_inflation
from inference.prepare import prepare
from inference.score import score
from inference.solver_result import RESULTS
from inference.trajectory import fit
from tentacle.servo_limits import ServoLimits
from tests.made_recordings import FPS


@pytest.fixture(scope="module")
def found(with_current):
    return stepwise_search(with_current)


def test_ljung_box_of_white_noise_is_its_degrees_of_freedom():
    random = np.random.default_rng(0)
    white = random.standard_normal((800, 5))
    statistic, freedom = ljung_box(white)
    assert freedom == 100
    assert abs(statistic - freedom) < 5.0 * np.sqrt(2.0 * freedom)
    # A first-order process with rho = .2 alone adds N rho^2 = 32 a channel at lag 1.
    coloured = white.copy()
    for k in range(1, 800):
        coloured[k] += 0.2 * coloured[k - 1]
    assert ljung_box(coloured)[0] > freedom + 5 * 32 * 0.5


def test_the_gates_pass_what_is_complete_and_fail_what_is_not(plain, with_current):
    assert plain.train.passed
    assert plain.judged.passed
    assert not with_current.train.passed
    assert with_current.train.structure > 1.0 > plain.train.structure


def test_nothing_hidden_nothing_named(plain):
    outcome = stepwise_search(plain)
    decision = decide_by_rules(outcome)
    assert outcome.chosen is plain
    assert (decision.verdict, decision.effects) == ("nothing_missing", ())
    assert probabilities(outcome) == {}
    assert decision.words == ()


def wandering(base, size, seed=0):
    """The base fitted to data with an error of that rms [noise sigmas] on top, which no effect of the catalogue makes:
    every coordinate wanders by itself, over a fifth of a second.
    """
    (experiment,) = base.problem.experiments
    seen = experiment.observation
    white = np.random.default_rng(seed).standard_normal(seen.coefficients.shape)
    slow = gaussian_filter1d(white, 0.1 * FPS, axis=0)
    error = np.linalg.solve(seen.root, (size / slow.std() * slow * experiment.noise_gain)[..., None])[..., 0]
    spoilt = replace(experiment, observation=replace(seen, coefficients=seen.coefficients + error))
    problem = replace(base.problem, experiments=(spoilt,))
    return problem, fit(problem, base.fitted.nuisances)


def test_where_the_model_s_own_error_hides_the_rest_it_says_so_and_is_less_sure(plain):
    """A rest that is granted to the reduction, and that nothing explains: nothing is named, and nothing is sure."""
    problem, fitted = wandering(plain, 2.0)
    assert not gated_hypothesis((), problem, fitted).passed
    decision = decide_by_rules(stepwise_search(gated_hypothesis((), problem, fitted, (2.0, 2.0))))
    assert decision.verdict == "nothing_missing"
    assert any("would not be detected" in sentence for sentence in decision.words)
    assert decision.confidence < decide_by_rules(stepwise_search(plain)).confidence - 0.1


def test_what_one_effect_brings_down_to_the_noise_was_no_error_of_the_model_s_own(with_current):
    """A current's residual that the model might have left by itself: no error of numerics looks just like a current."""
    size = with_current.train.structure
    granted = gated_hypothesis((), with_current.problem, with_current.fitted, (size, size))
    assert granted.passed
    outcome = stepwise_search(granted)
    assert decide_by_rules(outcome).effects[0] == "current"
    assert outcome.chosen.excess_rms < CLEARED * granted.excess_rms


def test_what_makes_a_model_pass_is_named_though_the_model_might_err_by_more_on_what_was_fitted(with_current):
    """On what was fitted its own error may hide a current, on what is held out it may not; the current clears both."""
    size = with_current.train.structure
    granted = gated_hypothesis((), with_current.problem, with_current.fitted, (size, 0.1 * size))
    assert granted.train.passed
    assert not granted.passed
    outcome = stepwise_search(granted)
    assert outcome.chosen.penalised_log_likelihood - granted.penalised_log_likelihood < material_gain(granted)
    assert decide_by_rules(outcome).effects[0] == "current"
    assert outcome.chosen.excess_rms < CLEARED * granted.excess_rms


def test_an_effect_s_law_may_err_by_its_share_of_what_it_explains(with_current):
    """Backlash is known to a fifth (a real coupling gives), other laws to 1.5 %; of two effects the shares' squares
    add.
    """
    left = with_current.train.structure
    assert with_current.laws_with("current")[0] == pytest.approx(0.015 * left)
    assert with_current.laws_with("backlash")[0] == pytest.approx(0.2 * left)
    second = replace(with_current, laws=(0.3, 0.4))
    assert second.laws_with("backlash")[0] == pytest.approx(np.hypot(0.3, 0.2 * left))


def test_a_hidden_current_is_named_and_measured(found):
    decision = decide_by_rules(found)
    assert decision.verdict in ("effect", "group")
    assert "current" in decision.effects
    place = found.chosen.problem.free.index(("current", "U_x"))
    low, high = parameter_interval(found.chosen, place, found.variance_inflation)
    # A 95 % interval, taken twice as wide: it holds the truth with a chance of 0.9999.
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    assert abs(middle - 0.03) < 2.0 * half
    assert half < 0.003
    assert structure_share(found, found.chosen) < 0.12
    assert variance_inflation(found.chosen) == pytest.approx(1.0, abs=0.3)


def test_an_explanation_whose_fit_did_not_converge_is_no_verdict_alone(found):
    stopped = replace(found.chosen, fitted=replace(found.chosen.fitted, result=RESULTS.MAX_STEPS))
    decision = decide_by_rules(replace(found, chosen=stopped))
    assert decision.verdict == "group"
    assert "current" in decision.effects
    assert len(decision.effects) > 1
    assert RESULTS.MAX_STEPS.message in decision.words[-1]
    alone = decide_by_rules(replace(found, chosen=stopped, rivals=(), single=(stopped,)))
    assert (alone.verdict, alone.effects) == ("unknown", ())


def test_an_account_that_leaves_next_to_nothing_in_millimetres_stands(found, with_current):
    """The gates weigh what is seen best; an account that fails them by what no midline shows is one, less surely."""
    failing = replace(found.chosen, train=with_current.train, judged=with_current.judged)
    outcome = replace(found, chosen=failing, rivals=(), core=failing)
    assert decide_by_rules(outcome).verdict == decide_by_rules(outcome, 0.06).verdict == "unknown"
    followed = decide_by_rules(outcome, 0.04)
    assert followed.verdict == "effect"
    assert "current" in followed.effects
    assert followed.confidence < decide_by_rules(found).confidence
    assert any("above the noise" in sentence for sentence in followed.words)


def test_what_an_account_leaves_is_counted_beyond_noise_and_reduction(recorded, found, with_current):
    """The right effect leaves next to nothing of the midline's error, none at all leaves all of it."""
    prepared = [prepare(recorded({("current", "U_x"): 0.03}), hold_out=True)]
    base = (with_current.problem, with_current.fitted)
    chosen = (found.chosen.problem, found.chosen.fitted)
    assert unexplained_share(base, chosen, prepared, 0.0, held_out=True) < 0.05
    assert unexplained_share(base, base, prepared, 0.0, held_out=True) == pytest.approx(1.0)
    # Where the reduction alone may leave more than the base does, nothing is known of it.
    assert unexplained_share(base, chosen, prepared, 1e3, held_out=True) == 1.0


def test_probabilities_sum_to_one(found):
    weights = probabilities(found)
    assert sum(weights.values()) == pytest.approx(1.0)
    assert max(weights, key=lambda name: weights[name]) == "current"


def test_adding_and_removing_an_effect_comes_back(with_current):
    candidate = next(c for c in score(with_current.problem, with_current.fitted) if c.effect.name == "current")
    added = refit(with_current, candidate)
    assert added.penalised_log_likelihood > with_current.penalised_log_likelihood + 100.0
    back = without(added, "current")
    assert back.effects == ()
    # The same least-squares problem again, perhaps at a finer step: the coarse one errs by 2 % of the rest at most.
    assert back.fitted.misfit == pytest.approx(with_current.fitted.misfit, rel=1e-3)


def test_an_effect_taken_out_leaves_the_rest_where_it_stood_until_it_is_fitted(with_current):
    """From there a twin takes its place: where the rest bends itself to the loss it may meet another valley."""
    candidate = next(c for c in score(with_current.problem, with_current.fitted) if c.effect.name == "current")
    added = refit(with_current, candidate)
    left, fitted = removed_without_refit(added, "current"), without(added, "current")
    assert left.effects == fitted.effects == ()
    kept = [place for place, (effect, _) in enumerate(added.problem.free) if effect != "current"]
    np.testing.assert_array_equal(left.fitted.values, added.fitted.values[kept])
    assert left.fitted.misfit > fitted.fitted.misfit > added.fitted.misfit


def test_a_set_of_effects_found_by_two_ways_is_one_rival(with_current):
    one, other = (replace(with_current, effects=effects) for effects in (("current", "drag"), ("drag", "current")))
    assert [h.effects for h in _best_of_each(one, [other, with_current])] == [one.effects, ()]


def test_proposals_keep_the_servo_s_limits_and_split_rivals(with_current):
    limits = ServoLimits(angle=0.5, speed=4.0, acceleration=40.0)
    t = np.linspace(0.0, 15.0, 6001)
    for waveform in candidates(limits, 0):
        theta, rate, acceleration = np.abs(waveform(t))
        assert theta.max() <= limits.angle
        assert rate.max() <= limits.speed
        assert acceleration.max() <= limits.acceleration * 1.02  # a chirp's own term, small beside omega^2
    ranked = {c.effect.name: c for c in score(with_current.problem, with_current.fitted)}
    chosen, rival = refit(with_current, ranked["current"]), refit(with_current, ranked["gravity_tilt"])
    proposal = propose_experiment(chosen, (rival,), limits, 0)
    assert proposal is not None
    assert proposal.nats > 5.0
    assert propose_experiment(chosen, (), limits, 0) is None
    # A rival that is the model itself cannot be split from it by any motion (Gauss-Newton: to a thousandth of a nat).
    motion = candidates(limits, 0)[5]
    assert _gap(chosen, chosen, with_current.problem.experiments[0], motion) < 1e-3
