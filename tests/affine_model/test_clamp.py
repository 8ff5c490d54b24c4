"""A clamp that gives: a rotational spring at the root, against beam theory, energy and the readable assembly."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from affine_model.arm import Arm, active_effects
from affine_model.curvature import midline
from affine_model.dynamics import balance
from affine_model.modes import modes
from affine_model.simulate import Start, Timing, simulate
from affine_model.statics import TipLoad, equilibrium
from tentacle.specimen import AIR, WATER, Cone, Gravity, Rectangle, Specimen
from tests.affine_model.one_step import accelerations_of_both

WEIGHTLESS = Gravity(0.0, 0.0)
BEAM = Specimen(Rectangle(0.02, 0.004), 0.2, 1070.0)
CONE = Specimen(Cone(0.0125, 0.003), 0.14, 1070.0, tip_mass=1e-3)
E = 3e5
BENDING = E * 0.02 * 0.004**3 / 12.0  # EI [N m^2]
SHARES = (0.02, 0.1, 0.5)  # l / L


def behind(specimen, share, **rest):
    """An arm behind a clamp that gives as that share of its length."""
    return Arm(replace(specimen, clamp_length=share * specimen.length), **rest)


@pytest.mark.parametrize("share", SHARES)
def test_a_tip_load_bends_the_beam_and_turns_its_clamp(parameters, share):
    # w = F L^3 / (3 E I) + F L^2 / k with k = E I / l. A linear curvature is in the space: the error is the next order
    # of the load, (w / L)^2 of 1e-8 and less.
    arm, length, force = behind(BEAM, share, fluid=AIR, gravity=WEIGHTLESS), BEAM.length, 3e-7
    q = equilibrium(arm, parameters(elasticity__E=E), load=TipLoad(force=(force, 0.0)))
    tip = midline(q, arm.root_turn(q), length, [1.0])[0]
    spring = BENDING / (share * length)
    assert tip[0] == pytest.approx(force * length**3 / (3.0 * BENDING) + force * length**2 / spring, rel=1e-6)
    assert arm.root_turn(q) == pytest.approx(-force * length / spring, rel=1e-6)  # towards +x is clockwise


@pytest.mark.parametrize("share", SHARES)
def test_the_first_frequency_is_that_of_a_beam_on_a_root_spring(parameters, share):
    # 1 + cos b cosh b = l/L b (sin b cosh b - cos b sinh b); a thin beam, so that rotary inertia (1e-6) is no matter.
    def characteristic(b):
        spring = share * b * (np.sin(b) * np.cosh(b) - np.cos(b) * np.sinh(b))
        return 1.0 + np.cos(b) * np.cosh(b) - spring

    thin = Specimen(Rectangle(2e-3, 1e-3), 1.0, 1070.0)
    root = brentq(characteristic, 0.5, 1.8751041)
    unit = np.sqrt(E * 1e-6 / 12.0 / 1070.0)  # sqrt(EI / (rho A)) / L^2 [rad/s]
    found = modes(behind(thin, share, fluid=AIR, gravity=WEIGHTLESS, order=6, nodes=12), parameters(elasticity__E=E))
    assert 2.0 * np.pi * found.frequency[0] == pytest.approx(root**2 * unit, rel=1e-5)


def test_the_compiled_kernel_is_the_readable_assembly(parameters):
    arm = behind(CONE, 0.1, fluid=WATER, gravity=Gravity(0.3), order=3)
    p = parameters(
        elasticity__E=2e5, damping__eta=2e3, drag__C_perp=1.1, added_mass__C_a=0.8, tip_mass__mass=1e-3,
        cubic_stiffness__beta=0.4, amplitude_damping__b=0.02, intrinsic_curvature__c0=0.3, soft_spot__depth=0.3,
    )  # fmt: skip
    change, expected = accelerations_of_both(arm, p)
    np.testing.assert_allclose(change, expected, rtol=1e-7)  # rounding, over the step: 1e-16 / 1e-4 of a rate


def test_a_clamp_without_loss_keeps_the_energy(parameters):
    # The midpoint rule is not exactly conservative for large motions: second order in the step. With the clamp's own
    # energy left out, the sum would swing by a tenth.
    share, p = 0.2, parameters(elasticity__E=E)
    arm = behind(BEAM, share, fluid=AIR, gravity=WEIGHTLESS, order=3)
    start = np.array([[0.6], [-0.5], [0.0]])

    def energies(step):
        count = round(3.0 / step)
        run = simulate(arm, p[:, None], np.zeros((3, count, 1)), Timing(step, iterations=4), start=Start(start))
        z, rate = (arm.from_monomial @ values[:, :, 0].T for values in (run.q, run.q_rate))
        still = np.zeros((2, z.shape[1]))
        mass = balance(arm, active_effects(p), p, np.append(z, still, 0).T, np.append(rate, still, 0).T).mass_matrix
        moving = 0.5 * np.einsum("jt,tjk,kt->t", rate, mass[:, :3, :3], rate)
        bend = arm.curvature_basis @ z
        along = 0.5 * BENDING / BEAM.length * (arm.rule.weights @ bend**2)
        turn = arm.root_turn(run.q[:, :, 0], 1)
        return moving + along + 0.5 * BENDING / (share * BEAM.length) * turn**2, turn

    (coarse, turn), (fine, _) = energies(2e-3), energies(1e-3)
    assert np.ptp(turn) > 0.05  # the clamp takes part
    assert np.ptp(fine) < 2e-4 * fine[0]
    assert np.ptp(fine) < 0.3 * np.ptp(coarse)


def test_a_rigid_clamp_is_as_before_and_a_little_give_changes_little(parameters):
    # Nothing is added at 0; the limit is smooth, so that a fit may start at a rigid clamp.
    p = parameters(elasticity__E=2e5, damping__eta=2e3, drag__C_perp=1.1)[:, None]
    middles = (np.arange(300) + 0.5) / 300.0
    base = np.stack([0.4 * np.sin(9 * middles), 3.6 * np.cos(9 * middles), -32.4 * np.sin(9 * middles)])[:, :, None]

    def shape(share):
        return simulate(behind(CONE, share, fluid=WATER), p, base, Timing(1 / 300)).q[-1, :, 0]

    assert behind(CONE, 0.0).node_count == behind(CONE, 0.0).nodes
    rigid, slopes = shape(0.0), [(shape(share) - shape(0.0)) / share for share in (1e-6, 1e-4)]
    assert np.abs(slopes[0]).max() > 0.1 * np.abs(rigid).max()
    np.testing.assert_allclose(slopes[0], slopes[1], rtol=1e-2)  # 1e-4 of the clamp's own size, and 1e-16 / 1e-6


def test_a_length_that_comes_out_of_an_array_is_as_good_as_one_that_was_written(parameters):
    # The kernel's text is made of the arm's numbers; np.int64(9) is no number of it.
    p, still = parameters(elasticity__E=2e5)[:, None], np.zeros((3, 40, 1))
    start = Start(np.array([[0.4], [-0.2]]))
    runs = [
        simulate(Arm(replace(CONE, clamp_length=length), WATER), p, still, Timing(1e-3), start=start).q
        for length in (0.01, np.array([0.01])[0])
    ]
    np.testing.assert_array_equal(*runs)
