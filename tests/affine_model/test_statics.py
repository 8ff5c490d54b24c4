"""Large static deflections against the elastica, the arm's own weight, and a pure moment."""

import numpy as np
import pytest

from affine_model.arm import Arm
from affine_model.curvature import midline, monomial_angle
from affine_model.statics import TipLoad, equilibrium
from tentacle.specimen import AIR, Cone, Fluid, Gravity, Rectangle, Specimen

WEIGHTLESS = Gravity(0.0, 0.0)
BEAM = Specimen(Rectangle(0.02, 0.004), 0.2, 1070.0)
E = 3e5
BENDING = E * 0.02 * 0.004**3 / 12.0  # EI [N m^2]


@pytest.mark.parametrize(
    ("load", "drop", "shortening", "angle"),
    [
        (1.0, 0.30172, 0.05643, 0.46135),
        (2.0, 0.49346, 0.16064, 0.78175),
        (5.0, 0.71379, 0.38763, 1.21537),
        (10.0, 0.81061, 0.55500, 1.43029),
    ],
)
def test_elastica_under_a_dead_tip_load(parameters, load, drop, shortening, angle):
    # P L^2 / EI = load. Six curvature coordinates; the table's five digits are reached to one unit, at load 10, where
    # the curvature is steepest at the clamp, to five.
    arm = Arm(BEAM, AIR, WEIGHTLESS, order=6, nodes=16)
    P = load * BENDING / 0.2**2
    q = equilibrium(arm, parameters(elasticity__E=E), load=TipLoad(force=(-P, 0.0)))
    x, y = midline(q, 0.0, 0.2, [1.0])[0] / 0.2
    tolerance = 1e-5 if load < 10 else 5e-5
    assert -x == pytest.approx(drop, abs=tolerance)
    assert 1.0 - y == pytest.approx(shortening, abs=tolerance)
    assert monomial_angle(q, [1.0])[0] == pytest.approx(angle, abs=tolerance)


def test_a_tip_moment_bends_the_beam_into_an_arc(parameters):
    # An arc is in every order's space: exact to Newton's tolerance, c = M L / EI, through more than half a turn.
    q = equilibrium(
        Arm(BEAM, AIR, WEIGHTLESS, order=3), parameters(elasticity__E=E), load=TipLoad(moment=4.0 * BENDING / 0.2)
    )
    np.testing.assert_allclose(q, [4.0, 0.0, 0.0], atol=1e-9)


def test_own_weight_of_the_horizontal_cone(parameters):
    # Reference: an Euler-Bernoulli elastica at g = 9.81 m/s^2 (standard gravity would give a drop of .024270), six
    # digits. The coordinates converge from 218 um too much (order 2) to 1 um (order 8).
    specimen = Specimen(Cone(0.0125, 0.001), 0.14, 1070.0)
    arm = Arm(specimen, AIR, Gravity(np.pi / 2, 9.81), order=8, nodes=16)
    q = equilibrium(arm, parameters(elasticity__E=2e5))
    drop, along = midline(q, 0.0, 0.14, [1.0])[0]
    assert along == pytest.approx(0.137193, abs=2e-6)
    assert drop == pytest.approx(0.024279, abs=2e-6)
    assert specimen.mass == pytest.approx(26.6287e-3, abs=5e-8)


def test_neutral_buoyancy_leaves_the_arm_straight(parameters):
    arm = Arm(Specimen(Cone(0.0125, 0.001), 0.14, 1070.0), Fluid(1070.0), Gravity(1.0), order=3)
    np.testing.assert_allclose(equilibrium(arm, parameters(elasticity__E=1e4)), 0.0, atol=1e-12)


def test_intrinsic_curvature_is_the_rest_shape(parameters):
    arm = Arm(BEAM, AIR, WEIGHTLESS, order=3)
    q = equilibrium(arm, parameters(elasticity__E=E, intrinsic_curvature__c0=0.7))
    np.testing.assert_allclose(q, [0.7, 0.0, 0.0], atol=1e-10)
