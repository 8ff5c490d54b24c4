"""Errors as stated, the paper's coordinates of a richer shape, and what the reduction loses."""

from dataclasses import replace

import numpy as np
import pytest

from affine_model.arm import parameter_index
from affine_model.curvature import legendre_to_monomial, midline
from inference.base_fit import Setting, fit_base
from inference.compare import COMPARED_PLACES, floor_errors, points_deviation, restricted, run_comparison, run_errors
from inference.discrepancy import model_discrepancy, without_discrepancy
from inference.fit import fit
from inference.judged_fit import judged_fit
from inference.measured_shapes import Tracker, fit_shapes, from_track
from inference.observation import POSE
from inference.prepare import prepare
from mujoco_ref.simulate import Setup, simulate
from tentacle.model import Estimate, Model
from tentacle.signals import Midline, MotorSignal, ShapeTrack
from tests.made_recordings import WAVE


def test_a_third_coordinate_aliases_into_the_two_that_are_kept():
    """A small q3 moves the midline by s^4/12, and s^4 is nearest to 1.5 s^3 - 15/28 s^2: (q1, q2) change by
    (-5/56, 3/4) q3.
    """
    s = np.linspace(0.0, 1.0, 401)
    q = np.array([[2e-3, -1e-3, 1e-3]])
    t, theta = np.zeros(1), np.zeros(1)
    seen = Midline(t, s, midline(q, theta, 0.14, s), np.full((1, s.size), 1e-4))
    observation = fit_shapes(seen, theta, 0.14, 5, Tracker(1e-4))
    two = restricted(observation, observation.coefficients, 2) @ legendre_to_monomial(2).T
    change = (two - q[:, :2])[0] / q[0, 2]
    # 401 points stand for the integral, to 1/401 of each entry.
    np.testing.assert_allclose(change, [-5.0 / 56.0, 0.75], rtol=0.03)
    # With three coordinates nothing is lost.
    three = restricted(observation, observation.coefficients, 3) @ legendre_to_monomial(3).T
    np.testing.assert_allclose(three, q, atol=1e-6)
    assert observation.coefficients.shape[1] == POSE + 5


def test_a_complete_model_s_error_is_its_floor(recorded, plain):
    prepared = prepare(recorded(), hold_out=True)
    prepared = replace(prepared, experiment=plain.problem.experiments[0])
    own = (plain.problem, plain.fitted)
    runs = [run_comparison(prepared, 0, own, own, held_out=True)]
    before, floor = run_errors(runs, [prepared], augmented=False), floor_errors(runs, [prepared], 0.0)
    # White noise of 0.1 mm in x and y: sqrt(2) 0.1 mm, over 160 frames of 21 points (2.5 % at three sigma);
    # a channel that looks noisier by chance (one in ten is off by 10 %) lifts the floor by 1 %.
    assert floor.midline_mm == pytest.approx(np.sqrt(2.0) * 0.1, rel=0.03)
    assert before.midline_mm == pytest.approx(floor.midline_mm, rel=0.04)
    for name in ("angle_rad", "q1", "q2"):
        # 160 frames: an rms good to 6 %.
        assert getattr(before, name) == pytest.approx(getattr(floor, name), rel=0.2)
    assert before.thrust_n is None
    assert runs[0][0].judged.sum() == pytest.approx(160, abs=3)


def test_the_reduction_s_error_is_found_against_the_chain(plain):
    lost = model_discrepancy(plain.problem, plain.fitted)
    # Two coordinates on a cone with r_tip/r0 = .4 lose about a tenth of a millimetre (closing the loop: .145 mm at
    # r_tip/r0 = .12 and 10 mm of motion), more than numerics and less than a millimetre.
    assert 0.01 < lost.millimetres < 1.0
    assert lost.structure > 0.0


def test_the_chain_s_error_taken_off_leaves_little_of_it(recorded):
    """A chain with nothing missing, seen as finely as a video shows it (10 um): three coordinates err far above that
    noise, and less what another run of the chain shows at the fitted parameters, by no more than is granted."""
    made = recorded(order=3)
    values = {"elasticity": {"E": 2e5}, "damping": {"eta": 1.5e3}, "drag": {"C_perp": 1.1}}
    tables = {effect: {n: Estimate.exact(v) for n, v in table.items()} for effect, table in values.items()}
    d = made.declaration
    chain = simulate(
        Model(d.specimen, d.fluid, d.gravity, 3, tables), WAVE, 8.0, 60.0, setup=Setup(s=made.midline.s)
    ).midline
    noise = 1e-5
    points = chain.xy + noise * np.random.default_rng(0).standard_normal(chain.xy.shape)
    seen = replace(chain, xy=points, sigma=np.full(points.shape[:2], noise))
    motor = MotorSignal(chain.t, WAVE(chain.t)[0], WAVE(chain.t)[0])
    setting = Setting(d, (prepare(replace(made, midline=seen, motor=motor), hold_out=True).experiment,), 3)
    problem, fitted = fit_base(setting, 3)
    lost = model_discrepancy(problem, fitted)
    assert lost.structure > 1.0
    less = without_discrepancy(problem, lost)
    relieved = fit(replace(less, parameters=fitted.parameters), fitted.nuisances)
    before = judged_fit(problem, fitted).train.structure
    assert before == pytest.approx(lost.structure, rel=0.3)  # the chain's own error is what was left
    assert judged_fit(less, relieved).train.structure < 0.3 * before


@pytest.mark.parametrize("rigid", [True, False])
def test_the_chain_is_seen_as_a_tracker_sees(recorded, rigid):
    """A track of the chain's edges, its base angle known or each frame's own: what the reduction says the chain shows
    beyond three coordinates is what there is, to the noise. Seen otherwise it would err by several sigmas, for richer
    shapes are bent into the coordinates by other weights.
    """
    made = recorded(order=3)
    values = {"elasticity": {"E": 2e5}, "damping": {"eta": 1.5e3}, "drag": {"C_perp": 1.1}}
    tables = {effect: {n: Estimate.exact(v) for n, v in table.items()} for effect, table in values.items()}
    d = made.declaration
    s = np.linspace(0.01, 0.99, 99)
    chain = simulate(Model(d.specimen, d.fluid, d.gravity, 3, tables), WAVE, 8.0, 60.0, setup=Setup(s=s)).midline
    theta = WAVE(chain.t)[0]
    noise = 2e-5  # m: of an edge's place; a hundred of them tell the shape to a few micrometres
    sharp = replace(chain, sigma=np.full(chain.xy.shape[:2], noise))
    exact = fit_shapes(sharp, theta, d.specimen.length, 4, Tracker(noise, True, rigid))
    kept = [0, *range(POSE, POSE + 4)]
    transform = np.eye(5)
    transform[1:, 1:] = legendre_to_monomial(4)
    covariance = np.array([np.linalg.inv((r.T @ r)[np.ix_(kept, kept)]) for r in exact.root])
    random = np.random.default_rng(0)
    error = np.array([np.linalg.cholesky(c) @ random.standard_normal(5) for c in covariance])
    if rigid:
        covariance[:, 0, :], covariance[:, :, 0], error[:, 0] = 0.0, 0.0, 0.0
        covariance[:, 0, 0] = 1e-12
    x = (exact.coefficients[:, kept] + error) @ transform.T
    frames = chain.t.size
    track = ShapeTrack(
        chain.t, x, transform @ covariance @ transform.T, np.ones(frames, bool), ("",) * frames, 1.0, 1e-6, np.zeros(2)
    )
    recording = replace(made, midline=None, shape=track, motor=MotorSignal(chain.t, theta, theta))
    setting = Setting(d, (prepare(recording, hold_out=True).experiment,), 3)
    problem, fitted = fit_base(setting, 3)
    lost = model_discrepancy(problem, fitted)
    assert lost.structure > 1.0
    less = without_discrepancy(problem, lost)
    relieved = fit(replace(less, parameters=fitted.parameters), fitted.nuisances)
    assert judged_fit(less, relieved).train.structure < 0.3


def test_the_reduction_s_error_with_an_effect_is_the_chain_s_that_has_it_too(recorded):
    """A fitted current acts on the chain as well, so what is left is as small as without (a chain that lacked it would
    be centimetres per second of water apart); one of the camera acts on neither, and changes nothing.
    """
    made = recorded({("current", "U_x"): 0.03}, order=3)
    experiment = prepare(made, hold_out=True).experiment
    problem, fitted = fit_base(Setting(made.declaration, (experiment,), 3), 3)
    bare = model_discrepancy(problem, fitted)

    def lost_with(**added: dict[str, float]):
        parameters, free = fitted.parameters.copy(), problem.free
        for effect, table in added.items():
            for name, value in table.items():
                parameters[parameter_index(effect, name)] = value
                free = (*free, (effect, name))
        return model_discrepancy(replace(problem, free=free), replace(fitted, parameters=parameters), tuple(added))

    np.testing.assert_array_equal(lost_with(camera_roll={"roll": 0.02}).beyond[0], bare.beyond[0])
    current = lost_with(current={"U_x": 0.03, "U_y": 0.0})
    assert current.structure < 2.0 * bare.structure
    without = judged_fit(problem, fitted).train.structure  # what a current less in the model leaves
    assert current.structure < 0.2 * without


@pytest.mark.parametrize(("scale_sigma", "counted"), [(2e-4, 1.5e-4), (1e-4, 1e-4)])
def test_a_track_s_floor_is_how_far_its_points_are_from_where_they_were(scale_sigma, counted):
    """Its root's angle errs as well as its shape, drawn 500 times, and its one scale by 1.5e-4 in all frames alike.
    What exceeds the scale's stated deviation is no error of the measurement.
    """
    random, frames, length = np.random.default_rng(2), 40, 0.12
    mixed = random.standard_normal((4, 4)) + np.eye(4)
    covariance = 1e-7 * mixed @ mixed.T
    true = random.normal(size=(frames, 4)) * np.array([0.01, 0.4, 0.2, 0.1])
    every, accepted, words = np.repeat(covariance[None], frames, axis=0), np.ones(frames, bool), ("",) * frames

    def seen(coefficients: np.ndarray, scale: float):
        track = ShapeTrack(np.arange(frames), coefficients, every, accepted, words, scale, scale_sigma, np.zeros(2))
        return from_track(track, np.zeros(frames), length)

    where, square = seen(true, 1.0).points(COMPARED_PLACES)[1], 0.0
    for _ in range(500):
        noisy = seen(true + random.standard_normal((frames, 4)) @ np.linalg.cholesky(covariance).T, 1.0 + counted)
        square += float(np.mean(np.sum((noisy.points(COMPARED_PLACES)[1] - where) ** 2, axis=2))) / 500
    observation = seen(true, 1.0 + 1.5e-4)
    stated = points_deviation(observation, np.arange(frames), np.ones(observation.root.shape[1]), COMPARED_PLACES)
    # Of 500 drawings of 40 frames a mean square is known to 1 %.
    assert np.sqrt(np.mean(stated**2)) == pytest.approx(np.sqrt(square), rel=0.02)
