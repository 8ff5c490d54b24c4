"""The identified arm as a URDF, as MuJoCo's own reader of URDF takes it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

from mujoco_ref.engine import mujoco
from mujoco_ref.export.urdf import export_urdf
from tentacle.cli import main
from tentacle.errors import InputError
from tentacle.io.model_file import write_model
from tentacle.specimen import Cone, Specimen
from tests.mujoco_ref.arms import model_of, swimming_model

LINKS = 12


@pytest.fixture(scope="module")
def arm():
    return swimming_model()


def test_another_reader_finds_the_arm_s_mass_length_and_damping(arm):
    made = export_urdf(arm, LINKS)
    model = mujoco.MjModel.from_xml_string(made.text)
    assert model.njnt == LINKS + 1
    section, specimen = arm.specimen.section, arm.specimen
    s = np.linspace(0.0, 1.0, 20001)
    area = np.array([float(section.area(value)) for value in s[::20]])
    mass = specimen.density * specimen.length * float(np.trapezoid(area, s[::20]))
    # The chain takes each link as it is cast: its mass is the integral; nine digits are written.
    assert float(model.body_mass.sum()) == pytest.approx(mass, rel=1e-5)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    # The centre of mass of the straight arm, along y: the same integral, s beside it.
    centre = specimen.length * float(np.trapezoid(area * s[::20], s[::20]) / np.trapezoid(area, s[::20]))
    whole = float(model.body_mass @ data.xipos[:, 1] / model.body_mass.sum())
    assert whole == pytest.approx(centre, rel=2e-3)  # what a link of a twelfth blurs
    hinges = [model.joint(f"hinge_{k}") for k in range(1, LINKS + 1)]
    assert all(float(joint.damping[0]) > 0.0 for joint in hinges)


def test_with_the_springs_of_its_comment_it_swings_as_a_beam_does():
    """A clamped beam's first frequency: omega = 1.8751^2 sqrt(E I / (rho A L^4)) (Timoshenko)."""
    E, radius, length, density, links = 2e5, 0.004, 0.2, 1070.0, 40
    made = export_urdf(model_of(Specimen(Cone(radius, radius), length, density)), links)
    listed = made.text.split("springs_N_m_per_rad: ")[1].splitlines()[0].split()
    model = mujoco.MjModel.from_xml_string(made.text)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    squares = eigh(np.diag([float(value) for value in listed]), mass[1:, 1:], eigvals_only=True)
    bending, line = E * np.pi * radius**4 / 4.0, density * np.pi * radius**2
    omega = 1.8751**2 * np.sqrt(bending / (line * length**4))
    # Hinges between the 40 links, half a link off the clamp: the error falls as one over their number, 1 / 40.
    assert np.sqrt(squares[0]) == pytest.approx(omega, rel=0.025)


def test_what_it_cannot_carry_is_named(arm, tmp_path, capsys):
    write_model(arm, tmp_path / "model.toml")
    assert main(["export", str(tmp_path / "model.toml"), "--to", "urdf", "--out", str(tmp_path / "arm")]) == 0
    said = capsys.readouterr().out
    assert "leaves out elasticity" in said
    assert "leaves out the water" in said
    assert "leaves out drag" in said
    assert (tmp_path / "arm" / "arm.urdf").exists()
    refused = ["export", str(tmp_path / "model.toml"), "--to", "urdf", "--out", str(tmp_path / "b")]
    assert main([*refused, "--recording", "run.rrd"]) == 2
    assert "follows no recording" in capsys.readouterr().err
    assert not (tmp_path / "b").exists()


def test_a_body_at_the_tip_is_refused(arm):
    heavy = replace(arm, specimen=replace(arm.specimen, tip_mass=0.002))
    with pytest.raises(InputError, match="body at its tip"):
        export_urdf(heavy, LINKS)
