"""The chain behind a clamp that gives: beam theory, convergence with the links, and a rigid clamp's limit."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from mujoco_ref.export.script import export_script
from mujoco_ref.export.urdf import export_urdf
from mujoco_ref.midline import chain_midline_points
from mujoco_ref.modes import natural_frequencies
from mujoco_ref.simulate import Initial, Setup, make_stepper, simulate, state_of_shape
from mujoco_ref.statics import chain_equilibrium
from tentacle.errors import InputError
from tentacle.specimen import AIR, Gravity, Rectangle, Specimen
from tentacle.waveform import Sine
from tests.mujoco_ref.arms import CONE, HORIZONTAL, model_of, swimming_model

E, RHO = 2e5, 1070.0  # of model_of
THIN = Specimen(Rectangle(2e-3, 1e-3), 1.0, RHO)  # rotary inertia is no matter: 1e-6


def behind(model, share):
    """The model's arm behind a clamp that gives as that share of its length."""
    return replace(model, specimen=replace(model.specimen, clamp_length=share * model.specimen.length))


@pytest.mark.parametrize("share", [0.02, 0.1, 0.5])
def test_the_first_frequency_is_that_of_a_beam_on_a_root_spring(share):
    # 1 + cos b cosh b = l/L b (sin b cosh b - cos b sinh b). Second order in 1 / links: 5e-4 at 20, 3e-5 at 80.
    def characteristic(b):
        spring = share * b * (np.sin(b) * np.cosh(b) - np.cos(b) * np.sinh(b))
        return 1.0 + np.cos(b) * np.cosh(b) - spring

    rate = np.sqrt(E * 1e-6 / 12.0 / RHO) / (2.0 * np.pi)  # sqrt(EI / (rho A)) / L^2 [Hz]
    exact = brentq(characteristic, 0.5, 1.8751041) ** 2 * rate
    model = behind(model_of(THIN), share)
    coarse, fine = (natural_frequencies(make_stepper(model, links=n), count=1)[0] / exact - 1.0 for n in (20, 80))
    assert 0.0 < fine < 4e-5
    assert coarse / fine == pytest.approx(16.0, rel=0.02)  # the rest is of fourth order


def test_the_weight_of_a_stiff_beam_turns_the_clamp():
    # A beam of weight W, held level: the moment W L / 2 over k = E I / l turns the root, and the beam sags W L^3 / (8
    # E I) besides. Of a sag of 1e-4 L, both are linear to 1e-7; 40 links sag 1 / (2 links^2) too little.
    light = Specimen(Rectangle(2e-3, 1e-2), 0.1, 10.0, clamp_length=0.02)
    stepper = make_stepper(model_of(light, AIR, HORIZONTAL), links=40)
    state = chain_equilibrium(stepper, 0.0)
    bending, weight = E * 2e-3 * 1e-6 / 12.0, light.mass * Gravity().magnitude
    turn = weight * 0.1 / 2.0 * 0.02 / bending
    assert state.q[3] == pytest.approx(-turn, rel=1e-4)
    angles = stepper.chain.tangent_angles(state.q[None])
    assert angles.shape == (1, 41)
    drop = chain_midline_points(angles, np.zeros((1, 2)), 0.1, np.array([1.0]))[0, 0, 0]
    assert drop == pytest.approx(turn * 0.1 + weight * 0.1**3 / (8.0 * bending), rel=1e-3)


def test_a_clamp_that_hardly_gives_is_rigid():
    # The motion moves in proportion to what the clamp gives: 1e-6 of the length turns it by a microradian.
    model, wave = swimming_model(added_mass={"C_a": 1.0}), Sine(0.5, 1.3)
    setup = Setup(initial=Initial(np.zeros(2)))
    rigid, soft = (simulate(behind(model, share), wave, 1.0, 30.0, setup=setup) for share in (0.0, 1e-6))
    np.testing.assert_allclose(soft.midline.xy, rigid.midline.xy, atol=1e-6 * CONE.length)
    np.testing.assert_allclose(soft.load_cell, rigid.load_cell, atol=1e-5 * np.ptp(rigid.load_cell))


def test_a_shape_turns_its_clamp_by_the_curvature_at_the_root():
    stepper = make_stepper(behind(model_of(CONE), 0.1), links=20)
    state = state_of_shape(stepper, np.array([0.6, -0.4]), 0.2)
    angles = stepper.chain.tangent_angles(state.q)
    assert angles[0] == pytest.approx(0.2 + 0.1 * 0.6, rel=1e-12)
    assert angles[-1] == pytest.approx(0.2 + 0.1 * 0.6 + 0.6 - 0.2, rel=1e-12)  # a linear curvature: exact


def test_a_chain_of_rigid_links_refuses_sections_that_shear():
    model = swimming_model()
    sheared = replace(model, specimen=replace(model.specimen, shear_compliance=1.0))
    with pytest.raises(InputError, match="shear_compliance"):
        make_stepper(sheared)


@pytest.mark.parametrize(
    "export",
    [export_urdf, lambda model: export_script(model, "pyelastica")],
    ids=["urdf", "script"],
)
def test_an_export_without_a_hinge_for_it_refuses_a_clamp_that_gives(export):
    with pytest.raises(InputError, match="clamp_length_m"):
        export(behind(swimming_model(), 0.05))
