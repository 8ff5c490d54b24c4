"""Errors as stated, the paper's coordinates of a richer shape, and what the reduction loses."""

import numpy as np
import pytest

from affine_model.curvature import legendre_to_monomial, midline
from affine_model.identify.observation import POSE, fit_shapes
from discovery.compare import errors, floor_errors, restricted, run_comparison
from discovery.prepare import prepare
from discovery.reduction import reduction_error
from tentacle.signals import Midline


def test_a_third_coordinate_aliases_into_the_two_that_are_kept():
    """A small q3 moves the midline by s^4/12, and s^4 is nearest to 1.5 s^3 - 15/28 s^2: (q1, q2) change by
    (-5/56, 3/4) q3.
    """
    s = np.linspace(0.0, 1.0, 401)
    q = np.array([[2e-3, -1e-3, 1e-3]])
    t, theta = np.zeros(1), np.zeros(1)
    seen = Midline(t, s, midline(q, theta, 0.14, s), np.full((1, s.size), 1e-4))
    observation = fit_shapes(seen, theta, 0.14, 5, 1e-4)
    two = restricted(observation, observation.coefficients, 2) @ legendre_to_monomial(2).T
    change = (two - q[:, :2])[0] / q[0, 2]
    # 401 points stand for the integral, to 1/401 of each entry.
    np.testing.assert_allclose(change, [-5.0 / 56.0, 0.75], rtol=0.03)
    # With three coordinates nothing is lost.
    three = restricted(observation, observation.coefficients, 3) @ legendre_to_monomial(3).T
    np.testing.assert_allclose(three, q, atol=1e-6)
    assert observation.coefficients.shape[1] == POSE + 5


def test_a_complete_model_s_error_is_its_floor(recorded, plain):
    from dataclasses import replace

    prepared = prepare(recorded(), hold_out=True)
    prepared = replace(prepared, experiment=plain.problem.experiments[0])
    own = (plain.problem, plain.fitted)
    runs = [run_comparison(prepared, 0, own, own, held_out=True)]
    before, floor = errors(runs, [prepared], augmented=False), floor_errors(runs, [prepared], 0.0)
    # White noise of 0.1 mm in x and y: sqrt(2) 0.1 mm, over 160 frames of 21 points (2.5 % at three sigma);
    # a channel that looks noisier by chance (one in ten is off by 10 %) lifts the floor by 1 %.
    assert floor.midline_mm == pytest.approx(np.sqrt(2.0) * 0.1, rel=0.03)
    assert before.midline_mm == pytest.approx(floor.midline_mm, rel=0.04)
    for name in ("angle_rad", "q1", "q2"):
        # 160 frames: an rms good to 6 %.
        assert getattr(before, name) == pytest.approx(getattr(floor, name), rel=0.2)
    assert before.thrust_n is None
    assert runs[0][0].judged.sum() == pytest.approx(160, abs=3)


def test_the_reduction_s_error_is_found_against_the_chain(recorded, plain):
    lost = reduction_error(recorded().declaration, plain.problem, plain.fitted)
    # Two coordinates on a cone with r_tip/r0 = .4 lose about a tenth of a millimetre (closing the loop: .145 mm at
    # r_tip/r0 = .12 and 10 mm of motion), more than numerics and less than a millimetre.
    assert 0.01 < lost.millimetres < 1.0
    assert lost.structure > 0.0
