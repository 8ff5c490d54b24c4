"""Errors as stated, the paper's coordinates of a richer shape, and what the reduction loses."""

import numpy as np
import pytest

from affine_model.curvature import legendre_to_monomial, midline
from affine_model.identify.observation import POSE, fit_shapes
from discovery.compare import errors, floor_errors, restricted, run_comparison
from discovery.prepare import prepare
from discovery.reduction import reduction_error
from tentacle.signals import Midline


def test_a_third_coordinate_aliases_into_two_as_measured():
    """closing_the_loop.md: q3 aliases into (q1, q2) as (+.46, -1.50) q3, written for a fit of midline points."""
    s = np.linspace(0.0, 1.0, 41)
    q = np.array([[0.2, -0.1, 0.02]])
    t, theta = np.zeros(1), np.zeros(1)
    seen = Midline(t, s, midline(q, theta, 0.14, s), np.full((1, s.size), 1e-4))
    observation = fit_shapes(seen, theta, 0.14, 5, 1e-4)
    two = restricted(observation, observation.coefficients, 2) @ legendre_to_monomial(2).T
    change = (two - q[:, :2])[0] / 0.02
    # A shape q3 s^3/3 is nearest to one of opposite sign in q1 and larger in q2.
    assert np.sign(change[0]) == -np.sign(change[1])
    assert abs(change[0]) == pytest.approx(0.46, abs=0.1)
    assert abs(change[1]) == pytest.approx(1.50, abs=0.15)
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
    # White noise of 0.1 mm in x and y: sqrt(2) 0.1 mm, over 160 frames of 21 points (2.5 % at three sigma).
    assert floor.midline_mm == pytest.approx(np.sqrt(2.0) * 0.1, rel=1e-6)
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
