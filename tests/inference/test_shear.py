"""How much sections shear is found from a midline; what lies on a section that stands askew turns with it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from affine_model.acceleration_beside import specific_force
from affine_model.arm import Arm, neutral_parameters, parameter_index
from affine_model.curvature import midline, monomial_angle
from affine_model.points_beside import points_beside
from affine_model.statics import TipLoad, equilibrium
from inference.appearance import Appearance, Motion
from inference.base_fit import Setting, fit_base
from inference.declared_arm import SHEAR
from inference.discrepancy import model_discrepancy
from inference.prepare import prepare
from inference.sensor import Gauge
from tentacle.declared import Uncertain
from tentacle.recording import Declaration
from tentacle.signals import StrainGauge
from tentacle.specimen import AIR, WATER, Gravity, Rectangle, Specimen
from tests.made_recordings import SPECIMEN, TRUTH, Run, record_declared

SHEARING = replace(SPECIMEN, shear_compliance=1.0)
BEAM = Specimen(Rectangle(0.03, 0.03), 0.1, 1070.0, shear_compliance=1.0)


def fitted_to(declaration):
    made = record_declared(Declaration(SHEARING, WATER), {}, Run(seconds=6.0, noise=3e-5))
    recording = replace(made, declaration=declaration)
    return fit_base(Setting(declaration, (prepare(recording, hold_out=False).experiment,), 2), 2)


def test_how_much_the_sections_shear_is_found_from_the_midline() -> None:
    unknown = Uncertain(SHEAR, 0.5, 0.5, 0.0, 10.0)
    fitted = fitted_to(Declaration(SPECIMEN, WATER, uncertain=(unknown,)))[1]
    for name, true in ((("declared", SHEAR), 1.0), (("elasticity", "E"), TRUTH["elasticity", "E"])):
        place = fitted.free.index(name)
        deviation = np.sqrt(fitted.covariance[place, place])
        assert abs(fitted.values[place] - true) < 4.0 * deviation  # one draw in 16 000 is farther
        assert deviation < 0.1 * true  # of .5 declared: the data decide
    assert 2.0 * fitted.misfit / fitted.count < 1.1  # a model that is right leaves the noise


def test_without_shear_the_arm_is_too_soft_and_leaves_a_misfit() -> None:
    fitted = fitted_to(Declaration(SPECIMEN, WATER))[1]
    assert fitted.values[fitted.free.index(("elasticity", "E"))] < 0.99 * TRUTH["elasticity", "E"]
    assert 2.0 * fitted.misfit / fitted.count > 1.5  # a misfit of .7 of the noise: it is .02 mm


def test_the_reductions_error_is_that_of_an_arm_whose_links_are_rigid() -> None:
    # The chain has no shear. Compared with an arm that has, the difference would be shear, and correct it away.
    problem, fitted = fitted_to(Declaration(SHEARING, WATER))
    rigid = replace(problem, arm=replace(problem.arm, specimen=SPECIMEN))
    found, expected = (model_discrepancy(one, fitted) for one in (problem, rigid))
    assert found is not None
    assert expected is not None
    assert found.millimetres == pytest.approx(expected.millimetres, rel=1e-6)


def test_markers_lie_on_sections_that_stand_askew() -> None:
    arm, q, d = Arm(BEAM, order=3), np.array([0.9, -0.9, 0.0]), np.array([0.0, 0.014, -0.014])
    theta, s = 0.1 + arm.root_turn(q), np.array([0.4, 0.95, 1.0])
    psi = 0.1 + arm.sections_at(s) @ arm.from_monomial @ q
    expected = midline(q, theta, BEAM.length, s) + d[:, None] * np.stack([np.cos(psi), np.sin(psi)], axis=1)
    found = points_beside(q, theta, BEAM.length, s, d, arm.askew)
    np.testing.assert_allclose(found, expected, atol=1e-9 * BEAM.length)
    askew = theta + monomial_angle(q, s) - psi
    assert np.max(np.abs(askew[1:])) > 2e-2  # .3 mm on the tip's face: a marker is seen to .01 mm


def test_a_gauge_sees_bending_alone() -> None:
    # F L (1 - s) d / (E I): what a gauge on the skin reads under a load at the tip, however much the sections shear.
    E, force, d = 2.6e5, 3e-5, 0.015
    arm = Arm(BEAM, AIR, Gravity(0.0, 0.0), 4)
    q = equilibrium(arm, parameters_of(E), load=TipLoad((force, 0.0)))[None, :, None]
    none = np.zeros(1)
    seen = Appearance(q, np.zeros((1, 1)), none, none, np.zeros((2, 1)), np.zeros((1, 1)), None, arm.askew)
    gauge = Gauge("root", 1e-6, StrainGauge(0.2, d))
    expected = -force * BEAM.length * 0.8 * d / (E * 0.03**4 / 12.0)
    assert gauge.read(seen, BEAM.length)[0, 0] == pytest.approx(expected, rel=1e-6)


def test_an_accelerometer_turns_with_its_section() -> None:
    # Against second differences of the place of a marker at the same spot, along that section's own normal.
    arm, h, place = Arm(BEAM, order=3), 1e-4, (0.95, 0.014)
    t = h * np.arange(-1, 2)
    q = np.stack([0.6 * np.sin(20 * t), -0.5 * np.cos(17 * t), 0.2 * np.sin(11 * t + 1.0)])  # (n, 3)
    rate = np.stack([12 * np.cos(20 * t), 8.5 * np.sin(17 * t), 2.2 * np.cos(11 * t + 1.0)])
    second = np.stack([-240 * np.sin(20 * t), 144.5 * np.cos(17 * t), -24.2 * np.sin(11 * t + 1.0)])
    theta = arm.root_turn(q)
    places = points_beside(q.T, theta, BEAM.length, [place[0]], [place[1]], arm.askew)[:, 0]
    accelerated = (places[2] - 2.0 * places[1] + places[0]) / h**2
    psi = float(arm.sections_at([place[0]])[0] @ arm.from_monomial @ q[:, 1])
    here = [one[None, :, 1:2] for one in (q, rate, second)]
    root = [arm.root_turn(one, 1) for one in here]
    motion = Motion(np.stack(here[1:]), np.stack(root[1:]), np.zeros((1, 2, 1)))
    none = np.zeros(1)
    seen = Appearance(here[0], root[0], none, none, np.zeros((2, 1)), np.zeros((1, 1)), motion, arm.askew)
    turning = seen.turning()
    assert turning is not None
    normal, tangent = specific_force(turning, motion.pull, BEAM.length, place)
    expected = accelerated @ np.array([[np.cos(psi), -np.sin(psi)], [np.sin(psi), np.cos(psi)]])
    np.testing.assert_allclose([normal[0, 0], tangent[0, 0]], expected, rtol=1e-4)  # of h^2 w^2 / 12


def parameters_of(E):
    values = neutral_parameters()
    values[parameter_index("elasticity", "E")] = E
    return values
