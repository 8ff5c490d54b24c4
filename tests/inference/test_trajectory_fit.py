"""The trajectory fit: shapes without loss, a minimum that scipy agrees with, intervals, bounds, base signals."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares

from affine_model.arm import Arm, neutral_parameters, parameter_index
from affine_model.base_laws import play_operator
from affine_model.base_signal import Steps, base_table, step_middles
from affine_model.curvature import legendre_to_monomial, midline
from affine_model.simulate import Start, Timing, simulate
from inference.estimates import interval, joint_posterior
from inference.experiment import Experiment, predict
from inference.fit import fit, unfitted
from inference.levenberg_marquardt import Rounds, minimise
from inference.measured_shapes import Tracker, fit_shapes, from_track
from inference.observation import POSE, ShapeObservation
from inference.sufficient_step import sufficient_step
from inference.trajectory import RAN_AWAY, Problem
from tentacle.signals import Midline, ShapeTrack
from tentacle.solver_result import RESULTS
from tentacle.specimen import WATER, Cone, Gravity, Specimen
from tentacle.waveform import Chirp, Sine

ARM = Arm(Specimen(Cone(0.0125, 0.004), 0.14, 1070.0), WATER, Gravity())
WAVE = Chirp(0.5, 0.3, 2.0, 6.0)
TRUTH = {("elasticity", "E"): 1.6e5, ("damping", "eta"): 1.5e3, ("drag", "C_perp"): 1.1}
SIGMA = 2e-4


def true_parameters():
    p = neutral_parameters()
    for name, value in TRUTH.items():
        p[parameter_index(*name)] = value
    return p


def seen_midline(seed):
    step = 1 / 600
    base = WAVE(step_middles(0.0, step, 3600))[:, :, None]
    batch = simulate(ARM, true_parameters()[:, None], base, Timing(step), start=Start(q=np.array([[0.1], [0.05]])))
    t = np.arange(0.0, 5.8, 1 / 40)
    q = CubicSpline(batch.t, batch.q[:, :, 0])(t)
    s = np.linspace(0.0, 1.0, 21)
    xy = midline(q, WAVE(t)[0], ARM.specimen.length, s)
    xy = xy + SIGMA * np.random.default_rng(seed).standard_normal(xy.shape)
    return Midline(t, s, xy, np.full(xy.shape[:2], SIGMA)), q


def experiment_of(data):
    shapes = fit_shapes(data, WAVE(data.t)[0], ARM.specimen.length, 4, Tracker(SIGMA))
    used = np.ones(data.t.size, dtype=bool)
    return Experiment("run", shapes, WAVE, 0.0, 5.8, None, used, np.ones(POSE + 4))


def problem_of(experiment, E=2.0e5):
    p = true_parameters()
    p[parameter_index("elasticity", "E")] = E
    return Problem(ARM, (experiment,), tuple(TRUTH), p, 1 / 300)


def test_shapes_are_found_without_loss_or_bias():
    data, q = seen_midline(1)
    shapes = fit_shapes(data, WAVE(data.t)[0], ARM.specimen.length, 4, Tracker(SIGMA))
    z = np.zeros((q.shape[0], POSE + 4))
    z[:, POSE : POSE + 2] = q @ np.linalg.inv(legendre_to_monomial(2)).T
    whitened = np.einsum("tkl,tl->tk", shapes.root, shapes.coefficients - z)
    # Unit variance, no bias: 232 frames x 8 numbers; 4 standard errors of a mean square are 4 sqrt(2 / 1856) = .13.
    assert abs(np.mean(whitened**2) - 1.0) < 0.13
    assert np.all(np.abs(whitened.mean(axis=0)) < 4.5 / np.sqrt(q.shape[0]))
    # What the 8 coefficients leave of 42 numbers a frame is noise too (34 x 232 of them: 4 standard errors are .065).
    assert abs(np.sum(shapes.residual_chi2) / np.sum(shapes.residual_count) - 1.0) < 0.065


def test_parameters_come_back_within_their_intervals():
    experiment = experiment_of(seen_midline(2)[0])
    found = fit(problem_of(experiment), (np.zeros(6),))
    spread = np.sqrt(np.diag(found.covariance))
    # Four standard deviations: a false alarm in one of 5000 such tests, and the seed is fixed.
    assert np.all(np.abs(found.values - list(TRUTH.values())) < 4 * spread)
    assert np.all(spread / found.values < 0.05)
    # The residual is as large as the noise that was put in: 1856 numbers, 4 standard errors.
    assert abs(2 * found.misfit / found.count - 1.0) < 0.14


def test_what_the_residuals_do_not_depend_on_may_have_any_value():
    """Where a weight hangs, if it weighs nothing: its interval is all that is possible, not a point."""
    experiment = experiment_of(seen_midline(6)[0])
    reach = ("tip_mass", "reach")
    problem = replace(problem_of(experiment), free=(*TRUTH, reach))
    found = fit(problem, (np.zeros(6),))
    assert found.undetermined == (reach,)
    assert interval(problem, found, reach) == (-0.3, 0.3)
    posterior = joint_posterior(problem, found)
    assert posterior is not None
    assert posterior.names == tuple(".".join(name) for name in TRUTH)
    alone = fit(problem_of(experiment), (np.zeros(6),))
    # The others are as well known as without it: the same inverse to rounding, at fits that agree to their tolerance.
    assert np.diag(found.covariance)[:3] == pytest.approx(np.diag(alone.covariance), rel=1e-3)


def test_an_unknown_of_one_recording_runs_the_others_no_second_time(monkeypatch):
    experiments = tuple(experiment_of(seen_midline(seed)[0]) for seed in (4, 5))
    problem = replace(problem_of(experiments[0]), experiments=experiments)
    start = np.concatenate([problem.parameters[problem.rows()], np.full(6, 0.01), np.full(6, -0.02)])
    batch = np.repeat(start[:, None], 5, axis=1)
    batch[0, 1] *= 1.1  # the modulus: both recordings
    batch[3, 2] += 0.1  # the first one's initial shape
    batch[9, 3:] += 0.1  # the second one's, twice alike
    widths = []

    def counted(arm, experiment, parameters, nuisances, step):
        widths.append(nuisances.shape[1])
        return predict(arm, experiment, parameters, nuisances, step)

    monkeypatch.setattr("inference.trajectory.predict", counted)
    together, _ = problem.residuals(batch)
    assert widths == [3, 3]
    alone = np.concatenate([problem.residuals(column[:, None])[0] for column in batch.T], axis=1)
    # Each lane is the same sum in another order: some hundred roundings of residuals up to 100 noise sigmas.
    assert np.max(np.abs(together - alone)) < 1e-9


def test_scipy_finds_the_same_minimum():
    experiment = experiment_of(seen_midline(3)[0])
    problem = problem_of(experiment)
    ours = fit(problem, (np.zeros(6),))
    scales, (low, high) = problem.scales(), problem.bounds()
    start = np.concatenate([[2.0e5, 1.5e3, 1.1], np.zeros(6)]) / scales
    theirs = least_squares(
        lambda x: problem.residuals((x * scales)[:, None])[0][:, 0],
        start,
        lambda x: problem.jacobian(x * scales) * scales,
        (low / scales, high / scales),
    )
    # Both stop where the sum of squares is flat to 1e-7: the minima agree to that, the values to a fraction of a sigma.
    assert ours.misfit == pytest.approx(theirs.cost, rel=1e-6)
    assert np.all(np.abs(ours.values - theirs.x[:3] * scales[:3]) < 0.01 * np.sqrt(np.diag(ours.covariance)))


def test_minimise_stops_on_a_bound_and_solves_rosenbrock():
    rosenbrock = (
        lambda x: np.stack([10 * (x[1] - x[0] ** 2), 1 - x[0]]),
        lambda x, _: (np.array([10 * (x[1] - x[0] ** 2), 1 - x[0]]), np.array([[-20 * x[0], 10.0], [-1.0, 0.0]])),
    )
    free = minimise(
        *rosenbrock, np.array([-1.2, 1.0]), (np.full(2, -9.0), np.full(2, 9.0)), tolerance=1e-12, rounds=Rounds(200)
    )
    assert np.allclose(free.unknowns, 1.0, atol=1e-6)
    assert free.result is RESULTS.CONVERGED
    bound = minimise(
        *rosenbrock,
        np.array([0.4, 0.2]),
        (np.full(2, -9.0), np.array([9.0, 0.25])),
        tolerance=1e-12,
        rounds=Rounds(200),
    )
    # With x2 held at .25 the minimum lies where d/dx1 of the sum vanishes: 200 x1^3 - 49 x1 - 1 = 0, the larger root.
    root = max(np.roots([200.0, 0.0, -49.0, -1.0]).real)
    assert bound.unknowns[1] == 0.25
    assert bound.result is RESULTS.AT_BOUND
    assert bound.unknowns[0] == pytest.approx(root, abs=1e-4)
    short = minimise(
        *rosenbrock, np.array([-1.2, 1.0]), (np.full(2, -9.0), np.full(2, 9.0)), tolerance=1e-12, rounds=Rounds(2)
    )
    assert short.result is RESULTS.MAX_STEPS
    assert not short.result.converged


def test_minimise_says_where_the_data_do_not_determine_an_unknown():
    # Two unknowns that act only by their sum: every split of the sum fits as well.
    found = minimise(
        lambda x: np.stack([x[0] + x[1] - 1.0, 2.0 * (x[0] + x[1]) - 2.1]),
        lambda x, _: (np.array([x[0] + x[1] - 1.0, 2.0 * (x[0] + x[1]) - 2.1]), np.array([[1.0, 1.0], [2.0, 2.0]])),
        np.zeros(2), (np.full(2, -9.0), np.full(2, 9.0)), tolerance=1e-12, rounds=Rounds(50),
    )  # fmt: skip
    assert found.unknowns.sum() == pytest.approx(1.04, abs=1e-6)
    assert found.result is RESULTS.SINGULAR


def test_a_tracks_covariance_is_passed_on_whole():
    covariance = np.array([[[4.0, 1.0, 0.5], [1.0, 2.0, -1.5], [0.5, -1.5, 3.0]]]) * 1e-6
    track = ShapeTrack(
        t=np.zeros(1), coefficients=np.array([[0.01, 0.3, -0.2]]), covariance=covariance,
        accepted=np.array([True]), reason=("",), scale=1.0, scale_sigma=0.01, base_shift=np.zeros(2),
    )  # fmt: skip
    shapes = from_track(track, np.zeros(1), 0.14)
    kept = [0, POSE, POSE + 1]
    root = shapes.root[0][np.ix_(kept, kept)]
    T = legendre_to_monomial(2)
    back = np.eye(3)
    back[1:, 1:] = T
    assert np.allclose(back @ np.linalg.inv(root.T @ root) @ back.T, covariance[0], rtol=1e-9)


def servo(*, tau=0.0, period=0.0, play=0.0):
    parameters = neutral_parameters()
    for effect, name, value in (("servo_lag", "tau", tau), ("servo_lag", "period", period), ("backlash", "play", play)):
        parameters[parameter_index(effect, name)] = value
    return parameters[:, None]


def test_a_servo_of_second_order_has_its_gain_and_phase():
    step, tau, period, omega = 1 / 400, 0.06, 0.25, 2 * np.pi * 1.3
    wave = lambda t: np.stack([np.sin(omega * t), omega * np.cos(omega * t), -(omega**2) * np.sin(omega * t)])  # noqa: E731
    table = base_table(wave, Steps(0.0, step, 1200), servo(tau=tau, period=period))[:, :, 0]
    t = step_middles(0.0, step, 1200)
    late = t > 1.0  # the transient of decay tau (2 pi / period)^2 / 2 = 19/s has died
    response = 1.0 / (1.0 + 1j * omega * tau - (omega * period / (2 * np.pi)) ** 2)
    for row, truth in zip(table, (1.0, 1j * omega, -(omega**2)), strict=True):
        exact = np.imag(truth * response * np.exp(1j * omega * t[late]))
        # Piecewise linear input: error (omega step)^2 / 12 = 3.5e-5.
        assert np.allclose(row[late], exact, atol=1e-4 * abs(truth))


def test_lag_is_the_exact_first_order_lag():
    step, tau, omega = 1 / 400, 0.05, 2 * np.pi * 1.3
    wave = lambda t: np.stack([np.sin(omega * t), omega * np.cos(omega * t), -(omega**2) * np.sin(omega * t)])  # noqa: E731
    table = base_table(wave, Steps(0.0, step, 1200), servo(tau=tau))[:, :, 0]
    t = step_middles(0.0, step, 1200)
    late = t > 10 * tau  # the transient has died to e^-10
    gain, phase = 1 / np.hypot(1, omega * tau), np.arctan(omega * tau)
    # Piecewise linear input: error (omega step)^2 / 12 = 3.5e-5.
    assert np.allclose(table[0, late], gain * np.sin(omega * t[late] - phase), atol=1e-4)
    assert np.allclose(table[2, late], -(omega**2) * gain * np.sin(omega * t[late] - phase), atol=1e-4 * omega**2)


@pytest.mark.parametrize(("tau", "play"), [(0.06, 0.0), (0.0, 0.05), (0.04, 0.05)])
def test_a_lag_and_a_gear_begin_with_what_they_went_through(tau, play):
    step, omega = 1 / 400, 2 * np.pi * 0.7
    wave = lambda t: np.stack([np.sin(omega * t), omega * np.cos(omega * t), -(omega**2) * np.sin(omega * t)])  # noqa: E731
    both = servo(tau=tau, play=play)
    whole = base_table(wave, Steps(0.0, step, 1200), both)[:, :, 0]
    late = base_table(wave, Steps(2.0, step, 400), both, known_from=0.0)[:, :, 0]
    assert np.allclose(late, whole[:, 800:], atol=1e-12)
    # Without its past a run begins elsewhere: a gear in its middle, a lag along the tangent.
    assert abs(base_table(wave, Steps(2.0, step, 400), both)[0, 0, 0] - late[0, 0]) > 1e-4


def test_a_step_at_which_the_motion_runs_away_is_not_taken_for_one_that_suffices():
    arm = Arm(Specimen(Cone(0.0125, 0.003), 0.14, 1070.0), WATER, Gravity(0.0), order=6, nodes=8)
    parameters = neutral_parameters()
    for (effect, name), value in ((("elasticity", "E"), 1e5), (("drag", "C_perp"), 1.0)):
        parameters[parameter_index(effect, name)] = value  # and no damping
    t = np.arange(0.0, 4.0, 1 / 60)
    wave = Sine(1.0, 6.0)  # so violent that the motion runs away at 1/75 s and at 1/150 s alike
    blank, unit = np.zeros((t.size, POSE + 6)), np.repeat(1e3 * np.eye(POSE + 6)[None], t.size, axis=0)
    observation = ShapeObservation(t, wave(t)[0], 0.14, blank, unit, np.zeros(t.size), np.zeros(t.size))
    experiment = Experiment("own", observation, wave, 0.0, 4.2, None, np.ones(t.size, bool), np.ones(POSE + 6))
    problem = Problem(arm, (experiment,), (("elasticity", "E"),), parameters, 1 / 1200)
    fitted = unfitted(problem, (np.zeros(14),))
    coarse = [unfitted(replace(problem, step=1 / rate), (np.zeros(14),)) for rate in (75, 150)]
    assert np.max(np.abs(fitted.used_residuals)) < RAN_AWAY
    assert all(np.max(np.abs(found.used_residuals)) == RAN_AWAY for found in coarse)
    assert sufficient_step(problem, fitted) < 1 / 150


def test_play_follows_behind_by_half_its_width():
    angle = np.concatenate([np.linspace(0, 1, 50), np.linspace(1, -1, 100)])
    output = play_operator(angle, 0.2)
    assert output[49] == pytest.approx(0.9)
    assert output[-1] == pytest.approx(-0.9)
    assert np.all(np.abs(output - angle) <= 0.1 + 1e-12)
