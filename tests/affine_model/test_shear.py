"""Sections that shear, against Timoshenko's beam: rest, frequencies, and the readable assembly."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from affine_model.arm import Arm
from affine_model.curvature import midline
from affine_model.modes import modes
from affine_model.shear import most_compliance, shear_of
from affine_model.statics import TipLoad, equilibrium
from tentacle.errors import InputError
from tentacle.specimen import AIR, WATER, Cone, Gravity, Rectangle, Specimen
from tests.affine_model.one_step import accelerations_of_both

WEIGHTLESS = Gravity(0.0, 0.0)
BEAM = Specimen(Rectangle(0.03, 0.03), 0.1, 1070.0, shear_compliance=1.0)
CONE = Specimen(Cone(0.0125, 0.005), 0.14, 1070.0, shear_compliance=1.0)
E = 2.6e5
BENDING, SHEARING = E * 0.03**4 / 12.0, 6.0 / 7.0 * E / 3.0 * 0.03**2  # E I [N m^2], kappa G A [N]


def tip_of(arm, q):
    return midline(q, arm.root_turn(q), arm.specimen.length, [1.0])[0]


@pytest.mark.parametrize("order", [2, 3, 5])
def test_a_tip_load_bends_and_shears_the_beam(parameters, order):
    # w = F L^3 / (3 E I) + F L / (kappa G A). A linear curvature is in the space: the error is the next order of the
    # load, (w / L)^2 of 1e-8 and less.
    arm, force, length = Arm(BEAM, AIR, WEIGHTLESS, order), 3e-5, BEAM.length
    q = equilibrium(arm, parameters(elasticity__E=E), load=TipLoad(force=(force, 0.0)))
    expected = force * length**3 / (3.0 * BENDING) + force * length / SHEARING
    assert tip_of(arm, q)[0] == pytest.approx(expected, rel=1e-6)
    turned = arm.sections_at([1.0])[0] @ arm.from_monomial @ q  # of the face that the load pushes: bending alone
    assert turned == pytest.approx(-force * length**2 / (2.0 * BENDING), rel=1e-6)


def test_the_weight_bends_and_shears_the_beam(parameters):
    # w = q L^4 / (8 E I) + q L^2 / (2 kappa G A), with a quadratic curvature exactly.
    load = 1e-4 * BEAM.density * 0.03**2 * 9.81
    arm = Arm(BEAM, AIR, Gravity(np.pi / 2.0, 9.81e-4), 3)
    q = equilibrium(arm, parameters(elasticity__E=E))
    expected = load * BEAM.length**4 / (8.0 * BENDING) + load * BEAM.length**2 / (2.0 * SHEARING)
    assert tip_of(arm, q)[0] == pytest.approx(expected, rel=1e-5)


def test_a_cone_under_a_tip_load_is_that_of_castigliano(parameters):
    # w = int F (L - x)^2 / (E I) + F / (kappa G A) dx. The curvature (1 - s) / I(s) is no polynomial: more coordinates
    # come closer, to bending and shear (2 % of it) alike.
    force, x = 3e-5, np.linspace(0.0, CONE.length, 20001)
    section, s = CONE.section, x / CONE.length
    bent = np.trapezoid(force * (CONE.length - x) ** 2 / (E * section.second_moment(s)), x)
    sheared = np.trapezoid(force / (0.9 * E / 3.0 * section.area(s)), x)
    assert sheared > 1.5e-2 * bent
    errors = []
    for order in (3, 5, 7):
        arm = Arm(CONE, AIR, WEIGHTLESS, order, 14)
        q = equilibrium(arm, parameters(elasticity__E=E), load=TipLoad((force, 0.0)))
        errors.append(abs(tip_of(arm, q)[0] / (bent + sheared) - 1.0))
    assert errors[0] < 2e-2  # 1.1 % without shear
    assert errors[1] < 2e-3  # .07 % without
    assert errors[2] < 1e-4


def test_the_first_frequency_is_that_of_timoshenkos_beam(parameters):
    # Han, Benaroya and Wei 1999 (J. Sound Vib. 225, 935): a clamped-free Timoshenko beam. The cut-off is far above, so
    # that the mode has a cosine and a hyperbolic pair. The slaved shear leaves out the shear that inertia's own
    # distribution adds beyond the moment's gradient: rotary inertia, 2 % of the translation, times shear, 8 %.
    thin = replace(BEAM, section=Rectangle(0.03, 0.015))
    area, moment, length = 0.03 * 0.015, 0.03 * 0.015**3 / 12.0, thin.length
    line, bending, shearing = 1070.0 * area, E * moment, 6.0 / 7.0 * E / 3.0 * area

    def determinant(w):
        a = line * w**2 / shearing  # of psi' = (w'' + a w)
        b = 1070.0 * moment * w**2 / shearing
        p = 0.5 * (a + 1070.0 * w**2 / E)
        root = np.sqrt(p**2 + line * w**2 / bending * (1.0 - b))
        alpha, beta = np.sqrt(root + p), np.sqrt(root - p)
        u, v = (alpha**2 - a) / alpha, (beta**2 + a) / beta
        # w = C1 sin + C2 cos + C3 sinh + C4 cosh; psi = -u C1' ... from w'' + a w = psi'
        sin, cos, sinh, cosh = (f(k * length) for f, k in
                                ((np.sin, alpha), (np.cos, alpha), (np.sinh, beta), (np.cosh, beta)))  # fmt: skip
        rows = [
            [0.0, 1.0, 0.0, 1.0],  # w(0)
            [u, 0.0, v, 0.0],  # psi(0)
            [-u * alpha * sin, -u * alpha * cos, v * beta * sinh, v * beta * cosh],  # psi'(L)
            [(alpha - u) * cos, -(alpha - u) * sin, (beta - v) * cosh, (beta - v) * sinh],  # w'(L) - psi(L)
        ]
        return np.linalg.det(np.array(rows))

    guess = 1.8751041**2 * np.sqrt(bending / line) / length**2
    exact = brentq(determinant, 0.8 * guess, 1.02 * guess)
    slender = modes(Arm(replace(thin, shear_compliance=0.0), AIR, WEIGHTLESS, 6, 12), parameters(elasticity__E=E))
    found = modes(Arm(thin, AIR, WEIGHTLESS, 6, 12), parameters(elasticity__E=E))
    assert 2.0 * np.pi * slender.frequency[0] > 1.008 * exact  # what shear does to it
    assert 2.0 * np.pi * found.frequency[0] == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize(("specimen", "clamp"), [(CONE, 0.0), (CONE, 0.1), (BEAM, 0.0)])
def test_the_compiled_kernel_is_the_readable_assembly(parameters, specimen, clamp):
    specimen = replace(specimen, clamp_length=clamp * specimen.length, tip_mass=2e-3, tip_mass_drop=3e-3)
    arm = Arm(specimen, WATER, Gravity(0.3), 3)
    p = parameters(elasticity__E=2e5, damping__eta=2e3, drag__C_perp=1.1, added_mass__C_a=0.8, soft_spot__depth=0.3)
    change, expected = accelerations_of_both(arm, p)
    np.testing.assert_allclose(change, expected, rtol=1e-7)  # rounding, over the step: 1e-16 / 1e-4 of a rate


def test_less_shear_approaches_an_arm_without(parameters):
    # The limit is smooth and linear, so that a fit may begin at either end.
    p = parameters(elasticity__E=E)
    tips = []
    for compliance in (0.0, 1e-3, 2e-3):
        arm = Arm(replace(CONE, shear_compliance=compliance), WATER, Gravity(0.7), 3)
        tips.append(tip_of(arm, equilibrium(arm, p)))
    first, second = tips[1] - tips[0], tips[2] - tips[1]
    np.testing.assert_allclose(first, second, rtol=2e-2)


def test_an_arm_too_thick_for_its_coordinates_is_refused():
    block = replace(BEAM, length=0.035)
    assert np.max(np.abs(shear_of(block, 2).gamma)) > 0.1
    with pytest.raises(InputError, match="shear_compliance"):
        shear_of(block, 7)
    most = most_compliance(block, 6)
    assert 0.0 < most < 1.0
    shear_of(replace(block, shear_compliance=1.05 * most), 6)  # a little beyond what a fit may try
