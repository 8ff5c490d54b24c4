"""The verdict is posterior mass and nothing else: made hypotheses, whose evidence is given."""

from dataclasses import replace

import numpy as np
import pytest

from affine_model.effects import absent_effects
from discovery.decide import ANOTHER_DAY, baseline_coarsening, decide_by_mass, log_masses, log_prior_of_set, missing_of
from inference.motion import ShownMotion
from inference.posterior import FORCE_SHARES, Hypothesis
from tentacle.solver_result import RESULTS


@pytest.fixture
def made(plain):
    """A hypothesis of these effects whose evidence peaks at a share, `nats` high."""

    def of(effects, share, nats, result=RESULTS.CONVERGED):
        evidence = nats - 3.0 * np.log(FORCE_SHARES / share) ** 2
        return Hypothesis(effects, plain.problem, replace(plain.fitted, result=result), (), evidence)

    return of


def test_a_prior_is_shared_by_all_sets_of_a_size():
    assert np.exp(log_prior_of_set(1)) > 10.0 * np.exp(log_prior_of_set(2))


def test_nothing_is_missing_where_no_effect_pays_for_itself(made):
    found = decide_by_mass([made((), 0.003, 0.0), made(("current",), 0.003, 2.0)])
    assert (found.verdict, found.effects) == ("nothing_missing", ())
    assert found.confidence > 0.5


def test_an_effect_far_ahead_is_named_and_certain(made):
    found = decide_by_mass([made((), 0.1, 0.0), made(("current",), 0.003, 60.0), made(("wall",), 0.03, 20.0)])
    assert (found.verdict, found.effects, found.certain) == ("effect", ("current",), ("current",))
    assert found.confidence > 0.99


def test_what_leaves_a_third_of_the_forces_is_no_name(made):
    found = decide_by_mass([made((), 0.3, 0.0), made(("current",), 0.3, 50.0)])
    assert found.verdict == "unknown"
    assert found.leading.effects == ("current",)


def test_explanations_that_do_as_well_are_a_group_and_what_they_share_is_certain(made):
    twins = [made((), 0.1, 0.0), made(("servo_lag",), 0.003, 50.0), made(("time_offset",), 0.003, 50.0)]
    found = decide_by_mass(twins)
    assert found.verdict == "group"
    assert set(found.effects) == {"servo_lag", "time_offset"}
    assert sum(mass for _, mass in found.sets) == pytest.approx(found.confidence)
    assert found.certain == ()


def test_what_credible_sets_share_is_the_answer_where_the_data_may_need_no_more(made):
    sets = [made((), 0.1, 0.0), made(("tip_mass",), 0.003, 48.0), made(("tip_mass", "wall"), 0.003, 50.0)]
    found = decide_by_mass(sets)
    assert (found.verdict, found.effects, found.certain) == ("effect", ("tip_mass",), ("tip_mass",))
    found = decide_by_mass([*sets[:2], made(("tip_mass", "wall"), 0.003, 53.5)])
    assert (found.verdict, found.effects) == ("effect", ("tip_mass",))
    masses = dict(found.sets)
    assert masses["tip_mass", "wall"] > masses[("tip_mass",)]
    assert found.leading.effects == ("tip_mass",), "the answer's model holds what is named, and no more"
    assert [h.effects for h in found.rivals] == [("tip_mass", "wall")]


def test_where_each_credible_set_has_more_than_they_share_all_of_them_are_the_answer(made):
    """A payload is certain, and one of two effects acts beside it: the answer is not the payload alone."""
    others = ("servo_lag", "time_offset")
    sets = [made((), 0.1, 0.0), *(made(("tip_mass", other), 0.003, 50.0) for other in others)]
    found = decide_by_mass([*sets, made(("tip_mass",), 0.003, 15.0)])
    assert (found.verdict, found.certain) == ("group", ("tip_mass",))
    assert set(found.effects) == {"tip_mass", *others}


def test_a_second_effect_is_named_by_less_where_the_first_leaves_little(made):
    """A wall gains 4000 nats, and an effect beside it 200. It may make up for an error in the wall's form, which would
    leave unknown forces too: beside the 10 % that are missing without the wall, 2 % tell of such an error, and .1 % do
    not.
    """

    def answer(share):
        sets = [made(("wall",), share, 4000.0), made(("wall", "servo_lag"), share, 4200.0)]
        return set(decide_by_mass([made((), 0.1, 0.0), *sets]).effects)

    assert answer(0.001) == {"wall", "servo_lag"}
    assert answer(0.02) == {"wall"}


def test_an_effect_that_leaves_noise_alone_is_named_though_programs_may_differ_by_more(made):
    """It gains 49 nats in so much motion that two programs may differ by as many. But where nothing is left of an error
    of 3000 ppm of the motion, it is the law itself. Where 800 ppm are left, it may be another error that resembles it.
    """

    def answer(rest: float):
        base = replace(made((), 0.001, 0.0), rest=270.0, rows=10_000, motion=ShownMotion(7e7, 3e7))
        return decide_by_mass([base, replace(made(("buoyancy",), 0.001, 49.0), rest=rest, rows=10_000)])

    assert answer(0.0).effects == ("buoyancy",)
    assert answer(20.0).verdict == "nothing_missing"
    assert answer(np.nan).verdict == "nothing_missing", "what a set leaves counts once it is known"


def test_an_effect_beside_doubtful_others_is_still_that_effect(made):
    """A rival of 3 % makes no group of what 97 % have in common, however many sets these are spread over."""
    doubtful = [one.name for one in absent_effects() if one.name not in ("tip_mass", "soft_spot")][:12]
    beside = [made(("tip_mass", name), 0.003, 50.0) for name in doubtful]
    sets = [made((), 0.1, 0.0), made(("tip_mass",), 0.003, 50.0), *beside]
    found = decide_by_mass([*sets, made(("soft_spot",), 0.003, 47.1)])
    assert max(found.masses[name] for name in doubtful) < found.masses["soft_spot"] < 0.05
    assert (found.verdict, found.effects, found.certain) == ("effect", ("tip_mass",), ("tip_mass",))
    ((held, mass),) = found.sets
    assert held == ("tip_mass",)
    assert mass == pytest.approx(found.confidence)
    found = decide_by_mass([*sets, made(("soft_spot",), 0.003, 49.0)])
    assert (found.verdict, set(found.effects)) == ("group", {"tip_mass", "soft_spot"})


def test_a_fit_that_did_not_converge_is_not_named(made):
    found = decide_by_mass([made((), 0.003, 0.0), made(("wall",), 0.003, 60.0, RESULTS.MAX_STEPS)])
    assert found.verdict != "effect"


def test_a_baseline_s_coarsening_exceeds_one_four_times_as_far_as_the_least_that_names_none_there():
    """With the least the likeliest set is as likely as none. A gain of one effect counts more than the same gain of
    three, for which the prior asks more. What noise alone may gain asks for no coarsening.
    """
    gains = [(1, 83.0), (2, 137.7), (3, 155.4)]
    least = 1.0 + (baseline_coarsening(gains) - 1.0) / ANOTHER_DAY
    ahead = [gain / least + log_prior_of_set(count) - log_prior_of_set(0) for count, gain in gains]
    assert max(ahead) == pytest.approx(0.0, abs=1e-12)
    assert baseline_coarsening([(3, 83.0)]) < baseline_coarsening([(1, 83.0)])
    assert baseline_coarsening([(1, 3.0), (2, 5.0)]) == 1.0


def test_errors_of_form_that_gain_so_much_more_on_another_day_are_one_case_of_twenty():
    """Eight errors of unit size in each of two recordings: an effect gains half the square of the error like it."""
    gains = 0.5 * np.random.default_rng(3).standard_normal((100_000, 2, 8)) ** 2
    one_day, another = gains.max(axis=2).T
    assert np.mean(another > ANOTHER_DAY * one_day) == pytest.approx(0.05, abs=0.005)  # of 100 000: +- .0014 by chance


def test_what_the_baseline_leaves_too_does_not_speak_against_an_effect(made):
    """The set's model alone leaves half of the residual; in the baseline, without any effect, as much is left."""

    def mass_of_something_else(baseline_rest: float) -> float:
        base = replace(made((), 0.05, 0.0), rest=4.0, rows=1000, baseline_share=0.03, baseline_rest=baseline_rest)
        payload = replace(made(("tip_mass",), 0.03, 80.0), rest=1.0, rows=1000)
        missing = missing_of([base, payload])
        within, beyond = log_masses(payload, missing)
        return float(1.0 / (1.0 + np.exp(within - beyond)))

    assert mass_of_something_else(1.0) < 0.5 * mass_of_something_else(0.0)
    # A baseline that leaves ten times as much in forces as a baseline may, counts a hundredth of its residual.
    worse = replace(made((), 0.05, 0.0), rest=4.0, rows=1000, baseline_share=0.5, baseline_rest=1.0)
    assert missing_of([worse]).declared_rest == pytest.approx(0.01, rel=1e-12)


def test_nothing_is_missing_only_where_no_more_is_left_than_the_baseline_lets_expect(made):
    """A steady force as small as the baseline's own explains any error, so that the forces alone say nothing."""

    def decided(rest: float, baseline_rest: float):
        base = replace(made((), 0.03, 0.0), rest=rest, rows=1000, baseline_share=0.03, baseline_rest=baseline_rest)
        return decide_by_mass([base, replace(made(("camera_roll",), 0.03, 1.0), rest=1.0, rows=1000)])

    assert decided(1.0, 1.0).verdict == "nothing_missing"
    assert decided(4.0, 4.0).verdict == "nothing_missing"
    assert decided(16.0, 1.0).verdict != "nothing_missing"
    assert decided(16.0, 0.0).verdict == "nothing_missing"  # there is no baseline


def test_the_judged_recordings_rest_is_not_thinned_by_a_baseline_that_is_followed(made):
    both = replace(made((), 0.03, 0.0), rest=2.0, rows=1000, rest_in_time=np.array([3.0, 5.0]))
    assert missing_of([both]).rest == 4.0
