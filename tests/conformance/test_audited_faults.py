"""Faults that an audit proved, each held to the number that physics gives."""

import numpy as np
import pytest

from affine_model.arm import active_effects
from affine_model.dynamics import Instant, balance
from affine_model.statics import equilibrium
from mujoco_ref.simulate import make_stepper
from mujoco_ref.statics import chain_equilibrium as rest_of_chain
from tentacle.specimen import AIR, STEEL, WATER, Fluid, Gravity
from tests.conformance.both_models import ORDER, Motion, bent, model_with, reduced

CURVED = {"intrinsic_curvature": {"c0": 0.5}}


@pytest.mark.parametrize("other", [{"soft_spot": {"depth": 0.5}}, {"stiffness_drift": {"rate": 0.02}}])
def test_a_softer_arm_keeps_the_shape_it_was_cast_in(other):
    model = model_with({**CURVED, **other}, AIR, Gravity(0.0, 0.0))
    _, _, arm, p, _ = reduced(model, Motion.drawn(0, still=True))
    q = equilibrium(arm, p, t=10.0)
    assert np.polynomial.polynomial.polyint(q)[1:].sum() == pytest.approx(0.5, abs=1e-9)  # the mean curvature
    assert 20.0 * rest_of_chain(make_stepper(model, links=20), 0.0).q[3:].mean() == pytest.approx(0.5, abs=1e-9)


@pytest.mark.parametrize("tangential", [0.0, 0.5, 1.0])
def test_swaying_water_pushes_a_fixed_arm_with_what_it_displaces_and_what_is_carried(tangential):
    """Force on a straight arm at rest, along its normal, over rho V du/dt: 1 (Froude-Krylov) + C_a, here 2."""
    sway = {"sloshing": {"U_cos": 0.0, "U_sin": 0.01, "f": 1.0}, "added_mass": {"C_a": 1.0, "tangential": tangential}}
    with_it, without = model_with(sway), model_with({**sway, "sloshing": {"U_sin": 0.0}})
    motion = Motion(np.zeros(ORDER), np.zeros(ORDER), 0.5 * np.pi, 0.0, np.zeros(ORDER), 0.0)  # x is along the tangent
    across = Motion(np.zeros(ORDER), np.zeros(ORDER), 0.0, 0.0, np.zeros(ORDER), 0.0)
    section = with_it.specimen.section
    s, w = np.polynomial.legendre.leggauss(8)
    volume = 0.07 * np.sum(w * section.area(0.5 * (s + 1.0)))
    payload = with_it.specimen.tip_mass / STEEL * 1.5  # its sphere carries half of what it displaces
    acceleration = 2.0 * np.pi * 0.01
    # Across, the torque about the clamp tells it, in both models. At t = 0 the water is still, and drags nothing.
    torques = [force[ORDER] for force in (reduced(with_it, across)[1], reduced(without, across)[1])]
    of_chain = [force[ORDER] for force in (bent(with_it, across, 40)[1], bent(without, across, 40)[1])]
    lever = 0.07 * np.sum(w * section.area(0.5 * (s + 1.0)) * 0.07 * (s + 1.0))
    reach = with_it.specimen.length + with_it.specimen.tip_mass_reach
    expected = -WATER.density * acceleration * (2.0 * lever + payload * reach)
    assert torques[0] - torques[1] == pytest.approx(expected, rel=1e-6)
    assert of_chain[0] - of_chain[1] == pytest.approx(expected, rel=1e-3)
    along = [model_force(motion_model, motion) for motion_model in (with_it, without)]
    assert along[0] - along[1] == pytest.approx(
        WATER.density * acceleration * (volume * (1.0 + tangential) + payload), rel=1e-6
    )


def model_force(model, motion):
    """Fluid force along x [N] of the reduced model."""
    _, _, arm, p, u = reduced(model, motion)
    return float(balance(arm, active_effects(p), p, u, 0.0 * u, Instant(motion.t)).fluid_force[0])


def test_a_steel_weight_loses_an_eighth_of_its_weight_in_water():
    hung = {"tip_mass": {"mass": 0.01, "reach": 0.0}}
    for pull in (lambda model: reduced(model, STILL)[1][-1], lambda model: bent(model, STILL, 20)[1][-1]):
        weight = [pull(model_with(hung, fluid)) - pull(model_with({}, fluid)) for fluid in (Fluid(0.0), WATER)]
        assert weight[0] == pytest.approx(0.01 * 9.80665 * np.cos(0.3), rel=1e-9)
        assert weight[1] / weight[0] == pytest.approx(1.0 - WATER.density / STEEL, rel=1e-9)


STILL = Motion.drawn(0, still=True)
