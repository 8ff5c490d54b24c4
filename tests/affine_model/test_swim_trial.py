"""Swimming trials against physics: symmetry, momentum on the rail, energy, and what the optimiser promises."""

from dataclasses import replace

import numpy as np
import pytest

from affine_model.arm import parameter_index
from affine_model.simulate import Rail
from affine_model.swim import (
    OBJECTIVES,
    PAPER_RAIL,
    GaitLimits,
    SearchPlan,
    assumed_model,
    best_sine,
    best_wave,
    cost_of_transport,
    optimise_gait,
    paper_cone,
    parameter_samples,
    robust_trial,
    run,
    search,
    search_box,
    sine_gaits,
    sine_map,
    trial_of,
)
from affine_model.swim.exact_gradient import exact_gradient
from affine_model.swim.objectives import exact_scores, gait_scores, worst_quarter_mean
from affine_model.swim.optimise import ORIGINS
from affine_model.swim.polish import polish, value_and_gradient
from affine_model.swim.robust import drawn_from, promised_interval
from tentacle.errors import InputError
from tentacle.model import Estimate
from tentacle.posterior import Posterior
from tentacle.servo_limits import ServoLimits
from tentacle.specimen import AIR

MODEL = assumed_model(paper_cone(0.21), "dragon-skin-10")
TRIAL = trial_of(MODEL)
BOX = search_box(TRIAL.limits)
THRUST = OBJECTIVES["thrust"]
UNCERTAIN = MODEL.with_effect("drag", C_perp=Estimate(1.1, 0.9, 1.3))


def test_left_and_right_thrust_alike():
    # Gravity points along the arm, so theta -> -theta mirrors the motion: thrust is the same, to rounding.
    alpha = BOX.alpha(np.random.default_rng(1).random((9, 12)))
    mirrored = alpha.copy()
    mirrored[6:] += np.pi
    one, other = run(TRIAL, alpha), run(TRIAL, mirrored)
    assert np.allclose(one.thrust, other.thrust, rtol=1e-6, atol=1e-9)


def test_a_beating_tail_swims_base_first():
    outcome = run(TRIAL.on_rail(PAPER_RAIL), sine_gaits(np.array([0.5]), np.array([1.0])))
    assert outcome.thrust[0, 0] > 0.0
    assert outcome.speed[0, 0] > 0.0


def test_momentum_on_the_rail():
    # Steady swimming on a level rail: mean fluid force = mean friction = viscous x speed. The mean is over whole
    # periods (1 Hz, 8 s); what is left is the step's error and the decaying start (rate viscous/mass = 1.6/s over 8 s:
    # 3e-6).
    rail = Rail(mass=0.25, viscous=0.4)
    trial = replace(trial_of(MODEL, nodes=8), settle=8.0, window=8.0, step=1 / 400).on_rail(rail)
    outcome = run(trial, sine_gaits(np.array([0.5, 0.3]), np.array([1.0, 2.0])))
    assert np.allclose(outcome.thrust, rail.viscous * outcome.speed, rtol=2e-3)


def test_the_servo_pays_for_what_the_water_takes():
    # A passive arm in still water only dissipates: the mean power over whole periods is positive.
    outcome = run(TRIAL, sine_gaits(np.array([0.2, 0.4, 0.6]), np.array([0.5, 1.0, 1.5])))
    assert np.all(outcome.power > 0.0)


def test_coarse_trial_agrees_with_the_fine_one():
    alpha = BOX.alpha(np.random.default_rng(2).random((9, 32)))
    coarse = run(TRIAL, alpha)
    fine = run(replace(trial_of(MODEL, nodes=8), step=1 / 480), alpha)
    scale = np.max(np.abs(fine.thrust))
    error = np.abs(coarse.thrust - fine.thrust) / scale
    # Second order in the step of 1/120 s; measured 0.1 % in the median and 2 % at worst, with room for other gaits.
    assert np.median(error) < 5e-3
    assert np.max(error) < 4e-2


def test_best_sine_is_the_best_of_a_fine_grid():
    alpha, value = best_sine(TRIAL, THRUST)
    grid = sine_map(TRIAL, THRUST, np.linspace(0.1, 1.04, 24), np.linspace(0.25, 2.5, 24))
    assert value >= np.nanmax(grid.values)
    assert alpha[1] == alpha[2] == 0.0
    # Beyond the servo's speed there is no such sine: the map says so.
    assert np.isnan(grid.values[-1, -1])


def test_gradient_by_batch_equals_richardson():
    unit = np.array([0.3, 0.4, 0.2, 0.4, 0.5, 0.3, 0.2, 0.6, 0.8])
    gentle = replace(TRIAL, limits=GaitLimits(ServoLimits(3.0, 60.0, 5000.0)))  # scaling has kinks, the model none
    _, coarse = value_and_gradient(gentle, THRUST, BOX, unit, 4e-4)
    _, fine = value_and_gradient(gentle, THRUST, BOX, unit, 2e-4)
    truth = (4.0 * fine - coarse) / 3.0
    _, used = value_and_gradient(gentle, THRUST, BOX, unit)
    # An offset of 1e-4 shifts the highest harmonic by up to 0.01 rad over the trial: its square is the truncation.
    assert np.allclose(used, truth, rtol=1e-3, atol=2e-4 * np.max(np.abs(truth)))


@pytest.mark.parametrize("name", ["thrust", "transport"])
def test_the_exact_gradient_is_right_to_a_millionth(name):
    objective = OBJECTIVES[name]
    short = replace(TRIAL, settle=1.0, window=1.0)
    trial = robust_trial(short.on_rail(PAPER_RAIL) if objective.on_rail else short, UNCERTAIN, 8, seed=0)
    unit = np.array([0.3, 0.2, 0.15, 0.4, 0.5, 0.3, 0.2, 0.6, 0.8])

    def scores(points):
        return exact_scores(objective, trial, run(trial, BOX.alpha(points)))

    value, gradient = exact_gradient(trial, objective, BOX, unit)
    assert value == pytest.approx(scores(unit[:, None])[0], rel=1e-12)
    differences = []
    for offset in (5e-5, 2.5e-5):
        steps = offset * np.eye(9)
        differences.append((scores(unit[:, None] + steps) - scores(unit[:, None] - steps)) / (2.0 * offset))
    truth = (4.0 * differences[1] - differences[0]) / 3.0  # Richardson: right to 4e-9 at these offsets
    assert np.max(np.abs(gradient - truth)) < 1e-6 * np.max(np.abs(truth))


def test_the_exact_gradient_of_a_gait_too_strong_for_the_servo():
    weak = replace(TRIAL, limits=replace(TRIAL.limits, torque=1e-3), settle=1.0, window=1.0)
    unit = np.array([0.3, 0.2, 0.15, 0.4, 0.5, 0.3, 0.2, 0.6, 0.8])
    value, gradient = exact_gradient(weak, THRUST, BOX, unit)
    offset, ahead = 1e-5, np.zeros(9)
    ahead[0] = offset
    pair = exact_scores(THRUST, weak, run(weak, BOX.alpha(np.stack([unit + ahead, unit - ahead], axis=1))))
    assert value < -1e3
    assert gradient[0] == pytest.approx((pair[0] - pair[1]) / (2.0 * offset), rel=1e-6)


def test_polish_by_the_exact_gradient_never_loses():
    plans = (SearchPlan(evaluations=50, seed=2, polish=polished) for polished in (False, True))
    usual, exact = (optimise_gait(TRIAL, THRUST, plan) for plan in plans)
    assert exact.value >= usual.value
    assert exact.origin == usual.origin


def test_polish_never_loses():
    unit = np.array([0.3, 0.4, 0.2, 0.4, 0.5, 0.3, 0.2, 0.6, 0.8])
    before = gait_scores(THRUST, TRIAL, run(TRIAL, BOX.alpha(unit[:, None])))[0]
    after = polish(TRIAL, THRUST, BOX, unit, evaluations=6).score
    assert after > before


def test_the_best_wave_keeps_the_servo_and_beats_the_sine():
    # The servo allows this arm a sine of 61 mN; a bent square wave of the same largest speed pulls 23 % more. The grid
    # closes in to 1/27 of its first width, so a fresh grid across one frequency's bends is nowhere higher.
    alpha, value = best_wave(TRIAL, THRUST)
    _, of_sine = best_sine(TRIAL, THRUST)
    assert value > 1.2 * of_sine
    assert np.count_nonzero(alpha[:3]) == 1
    around = np.repeat(alpha[:, None], 24, axis=1)
    around[7] = np.linspace(0.0, 2.0 * np.pi, 24)
    around[1] = TRIAL.limits.servo.angle
    assert np.max(gait_scores(THRUST, TRIAL, run(TRIAL, around))) <= value * (1.0 + 1e-9)


def test_more_evaluations_never_give_less():
    # A climb starts wherever the search rises above all before it, so fewer evaluations judge a part of the same gaits.
    values = [optimise_gait(TRIAL, THRUST, SearchPlan("random", count, 1)).value for count in (50, 100, 400)]
    assert values == sorted(values)
    assert values[0] > 0.0


def test_the_optimised_gait_obeys_the_servo_and_beats_the_sine():
    result = optimise_gait(TRIAL, THRUST, SearchPlan(evaluations=192, seed=4))
    t = np.arange(0.0, 120.0, 1e-3)
    peaks = np.max(np.abs(result.gait(t)), axis=1)
    assert np.all(
        peaks <= TRIAL.limits.bounds.kinematic * 1.001
    )  # sampled at 2 ms: a peak in between is (2 pi 5 Hz x 1 ms)^2/2 higher
    assert result.promise.torque <= TRIAL.limits.torque
    assert result.gain > 1.2
    assert result.origin in ORIGINS
    assert result.promise.thrust >= result.sine_promise.thrust
    assert np.all(np.diff(result.best) >= 0.0)


def test_a_weak_servo_is_obeyed_too():
    weak = replace(TRIAL, limits=GaitLimits(torque=0.005))
    free = run(TRIAL, best_sine(TRIAL, THRUST)[0][:, None])
    assert free.torque[0, 0] > 0.005  # the limit matters
    alpha, _ = best_sine(weak, THRUST)
    assert run(weak, alpha[:, None]).torque[0, 0] <= 0.005


def test_samples_follow_the_intervals():
    samples = parameter_samples(MODEL, 4001, seed=1)
    again = parameter_samples(MODEL, 4001, seed=1)
    assert np.array_equal(samples, again)
    varied = np.flatnonzero(np.ptp(samples, axis=1) > 0.0)
    assert len(varied) == 4
    estimate = MODEL.parameters["drag"]["C_perp"]
    row = next(index for index in varied if samples[index, 0] == estimate.value)
    # 4000 draws: the standard deviation is known to 1/sqrt(8000) = 1.1 %, three times that is allowed.
    assert np.std(samples[row, 1:]) == pytest.approx((estimate.high - estimate.low) / 3.92, rel=0.035)


def test_samples_follow_the_joint_posterior():
    # E and eta together, drag and added mass by their own intervals. A correlation r of 4000 draws is right to
    # (1 - r^2) / sqrt(4000).
    known = Posterior(("elasticity.E", "damping.eta"), (3e3, 20.0), ((1.0, 0.9), (0.9, 1.0)))
    model = replace(UNCERTAIN, posterior=known)
    for effect, name in (("elasticity", "E"), ("damping", "eta")):
        value = MODEL.value(effect, name)
        model = replace(
            model, parameters={**model.parameters, effect: {name: Estimate(value, 0.9 * value, 1.1 * value)}}
        )
    samples = parameter_samples(model, 4001, seed=1)[:, 1:]
    e, eta, drag = (
        samples[parameter_index(*name)] for name in (("elasticity", "E"), ("damping", "eta"), ("drag", "C_perp"))
    )
    assert np.std(e) == pytest.approx(3e3, rel=0.035)
    assert np.corrcoef(e, eta)[0, 1] == pytest.approx(0.9, abs=0.01)
    assert abs(np.corrcoef(e, drag)[0, 1]) < 0.06
    assert drawn_from(model) == "the joint posterior of 2 parameters and 2 intervals, each by itself"
    assert "4 intervals" in drawn_from(replace(model, posterior=None))


def test_the_promised_interval_holds_what_new_draws_give():
    objective, alpha = THRUST, sine_gaits(np.array([0.5]), np.array([1.0]))
    low, high = promised_interval(TRIAL, UNCERTAIN, objective, alpha[:, 0], (400, 1))
    judged = run(robust_trial(TRIAL, UNCERTAIN, 400, seed=2), alpha).thrust[0]
    # The quantiles of 400 draws are each right to .8 % of mass; two sets differ by sqrt(2) of it.
    assert np.mean((judged >= low) & (judged <= high)) == pytest.approx(0.95, abs=0.04)


def test_robust_trial_scores_the_worst_quarter():
    trial = robust_trial(TRIAL, MODEL, 8, seed=2)
    outcome = run(trial, sine_gaits(np.array([0.5, 0.5]), np.array([0.8, 1.0])))
    assert outcome.thrust.shape == (2, 8)
    single = run(TRIAL, sine_gaits(np.array([0.5]), np.array([0.8])))
    assert outcome.thrust[0, 0] == pytest.approx(single.thrust[0, 0], rel=1e-9)
    lowest_two = np.sort(outcome.thrust, axis=1)[:, :2].mean(axis=1)
    assert np.allclose(gait_scores(THRUST, trial, outcome), lowest_two)
    assert np.allclose(worst_quarter_mean(outcome.thrust[:, :1]), outcome.thrust[:, 0])


def test_cost_of_transport_counts_the_board():
    outcome = run(TRIAL.on_rail(PAPER_RAIL), sine_gaits(np.array([0.5]), np.array([1.0])))
    expected = (outcome.power[0, 0] + 0.1) / outcome.speed[0, 0]
    assert cost_of_transport(outcome)[0, 0] == pytest.approx(expected)


def test_what_cannot_swim_is_one_line():
    with pytest.raises(InputError, match="no water"):
        trial_of(replace(MODEL, fluid=AIR))
    with pytest.raises(InputError, match="interval"):
        parameter_samples(replace(MODEL, parameters={"elasticity": {"E": Estimate.exact(2e5)}}), 4, 0)
    with pytest.raises(InputError, match="not known"):
        assumed_model(paper_cone(0.14), "rubber")


def test_torch_and_numpy_pick_the_same_gait():
    """The population as a tensor on the CPU: the same kernel on the same memory, so the same search to the last bit."""
    box = search_box(TRIAL.limits)
    brief = replace(TRIAL, settle=0.5, window=1.0)
    courses = [
        [g.scores for g in search(replace(brief, device=device), THRUST, box, SearchPlan("ga", 150, 3))]
        for device in (None, "cpu")
    ]
    np.testing.assert_array_equal(*courses)


def test_the_last_bits_of_another_device_choose_no_other_gait(monkeypatch):
    """Two devices differ by 2e-14. A gait and its mirror image have equal thrust: such noise must not choose."""
    import affine_model.swim.trial as module

    plan, draws, exact = SearchPlan(evaluations=96), np.random.default_rng(0), module.evaluate
    expected = optimise_gait(TRIAL, THRUST, plan)

    def shaken(*given):
        rows = exact(*given)
        rows[:4] *= 1.0 + 2e-14 * draws.standard_normal(rows[:4].shape)
        return rows

    monkeypatch.setattr(module, "evaluate", shaken)
    found = optimise_gait(TRIAL, THRUST, plan)
    assert found.gait == expected.gait
    np.testing.assert_array_equal(found.best, expected.best)
