import shutil
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from mujoco_ref.engine import mujoco
from mujoco_ref.export.arm_forces import Forces, drive
from mujoco_ref.export.imported import import_arm
from mujoco_ref.export.mjcf import export_mjcf
from mujoco_ref.export.write import write_mjcf
from mujoco_ref.midline import chain_midline_points
from mujoco_ref.simulate import Initial, Setup, simulate
from tentacle.errors import InputError
from tentacle.waveform import Ramped, Sine
from tests.mujoco_ref.arms import swimming_model

WAVE = Ramped(Sine(0.5, 1.3), 0.5)
S = np.linspace(0.0, 1.0, 11)
LINKS = 12
EVERYTHING = {
    "added_mass": {"C_a": 1.0, "tangential": 0.3, "convective": 0.4},
    "skin_drag": {"C_t": 0.05},
    "linear_drag": {"c_n": 0.3},
    "current": {"U_x": 0.03, "U_y": 0.01},
    "sloshing": {"U_cos": 0.03, "U_sin": 0.02, "V_cos": 0.01, "V_sin": -0.02, "f": 1.1},
    "buoyancy": {"density_error": 30.0},
    "gravity_tilt": {"tilt": 0.1},
    "tip_mass": {"mass": 0.002, "reach": 0.1},
    "amplitude_damping": {"b": 0.01},
    "soft_spot": {"depth": 0.3, "s0": 0.3},
    "cubic_stiffness": {"beta": 0.4},
    "intrinsic_curvature": {"c0": 0.2},
    "viscoelasticity": {"g": 0.3, "tau": 0.2},
    "dry_friction": {"c_f": 0.1, "slip": 0.03, "sliding": 0.4, "rate": 2.0},
    "stiffness_drift": {"rate": 0.01},
    "wall": {"B": 5.0, "distance": 0.5},
    "cross_flow": {"share": 0.5},
    "reynolds_drag": {"share": 0.5},
    "oscillating_drag": {"share": 1.0, "f": 1.3},
    "shed_tip": {"span": 0.01},
    "vortex_lift": {"C_cos": 0.3, "C_sin": 0.3, "U": 0.1},
}


def behind_clamp(model):
    """The same arm behind a clamp that gives as 14 mm of it."""
    return replace(model, specimen=replace(model.specimen, clamp_length=0.1 * model.specimen.length))


def run(xml, *, exact, seconds=1.5):
    """Times and midlines of an exported arm under WAVE, from rest."""
    model = mujoco.MjModel.from_xml_string(xml)
    forces = Forces(model) if exact else None
    try:
        if forces is not None:
            forces.attach()
        t = np.arange(0.0, seconds, 1.0 / 60.0)
        positions = drive(model, mujoco.MjData(model), WAVE, t)
    finally:
        mujoco.set_mjcb_passive(None)
    hinges = sum(model.joint(j).name.startswith("hinge_") for j in range(model.njnt))
    angles = np.cumsum(positions[:, : hinges + 1], axis=1)[:, hinges - LINKS :]  # behind the clamp's own, if it gives
    return t, chain_midline_points(angles, np.zeros((len(t), 2)), 0.14, S)


def away_mm(model, xy, t):
    """Distance of a midline from the reference's, and the reference's own motion at the tip, rms [mm]."""
    wanted = simulate(
        model, WAVE, t[-1], 60.0, setup=Setup(links=LINKS, s=S, longest_step=1e-3, initial=Initial(np.zeros(2)))
    ).midline.xy
    apart = np.sqrt(np.mean(np.sum((xy[: len(wanted)] - wanted) ** 2, axis=2)))
    swing = np.sqrt(np.mean(np.sum((wanted[:, -1] - wanted[:, -1].mean(axis=0)) ** 2, axis=1)))
    return 1e3 * apart, 1e3 * swing


@pytest.mark.parametrize("clamped", [lambda model: model, behind_clamp], ids=["rigid", "giving"])
def test_with_its_forces_every_effect_moves_as_in_the_reference(clamped):
    model = clamped(swimming_model(**EVERYTHING))
    made = export_mjcf(model, LINKS)
    apart, swing = away_mm(model, *reversed(run(made.xml, exact=True)))
    assert apart < 1e-3 * swing
    assert not made.carried.left


@pytest.mark.parametrize("clamped", [lambda model: model, behind_clamp], ids=["rigid", "giving"])
def test_mujoco_alone_stands_in_for_drag_and_added_mass(clamped):
    model = clamped(swimming_model(added_mass={"C_a": 1.0}))
    apart, swing = away_mm(model, *reversed(run(export_mjcf(model, LINKS).xml, exact=False)))
    assert apart < 0.03 * swing


def test_what_is_in_neither_file_is_named():
    model = swimming_model(camera_roll={"roll": 0.02}, servo_lag={"tau": 0.02})
    made = export_mjcf(model, LINKS)
    assert set(made.carried.left) == {"camera_roll", "servo_lag"}
    assert "Neither carries camera_roll: the measurement" in made.xml


def test_the_written_files_run_without_this_project(tmp_path):
    write_mjcf(swimming_model(added_mass={"C_a": 1.0}), tmp_path / "arm", 8)
    program = (
        "import mujoco, numpy as np\nfrom arm_forces import Forces, drive\n"
        "model = mujoco.MjModel.from_xml_path('arm.xml')\nforces = Forces(model)\ndata = mujoco.MjData(model)\n"
        "forces.attach()\n"
        "q = drive(model, data, lambda t: (0.3 * np.sin(6 * t), 1.8 * np.cos(6 * t), -10.8 * np.sin(6 * t)), [0.2])\n"
        "print(q[0, 0], np.abs(forces.drag).max())"
    )
    done = subprocess.run(
        [sys.executable, "-I", "-c", "import sys; sys.path.insert(0, '.')\n" + program],
        cwd=tmp_path / "arm", capture_output=True, text=True, check=True,
    )  # fmt: skip
    theta, drag = map(float, done.stdout.split())
    assert theta == pytest.approx(0.3 * np.sin(1.2), abs=1e-4)
    assert drag > 0.0


@pytest.mark.parametrize("clamped", [lambda model: model, behind_clamp], ids=["rigid", "giving"])
def test_an_exported_arm_comes_back(tmp_path, clamped):
    model = clamped(swimming_model(added_mass={"C_a": 1.0}))
    write_mjcf(model, tmp_path / "arm")
    found = import_arm(tmp_path / "arm" / "arm.xml").model
    assert found.value("elasticity", "E") == pytest.approx(2e5, rel=0.02)
    assert found.value("damping", "eta") == pytest.approx(300.0, rel=0.02)
    assert found.value("added_mass", "C_a") == 1.0
    assert found.specimen.section.base_radius == pytest.approx(0.0125, rel=0.01)
    assert found.specimen.length == pytest.approx(0.14, rel=1e-6)
    assert found.specimen.clamp_length == pytest.approx(model.specimen.clamp_length, rel=0.05)  # of E I0 as it is read
    assert found.specimen.mass == pytest.approx(model.specimen.mass, rel=0.01)
    assert found.gravity.angle == pytest.approx(0.0, abs=1e-9)


CAPSULES = """<mujoco><option gravity="0 0 -9.81"/><worldbody>{}</worldbody></mujoco>"""
LINK = """<body pos="{x} 0 0"><joint type="hinge" axis="0 1 0" stiffness="0.02" damping="1e-4" {more}/>
<geom type="cylinder" fromto="0 0 0 0.02 0 0" size="0.005" density="1000"/>{inner}</body>"""


def chain(count, more=""):
    """A chain of equal links, as anyone would write it."""
    inner = ""
    for k in reversed(range(count)):
        inner = LINK.format(x=0.0 if k == 0 else 0.02, inner=inner, more=more)
    return CAPSULES.format(inner)


def test_a_chain_of_another_program_becomes_a_specimen(tmp_path):
    (tmp_path / "arm.xml").write_text(chain(8))
    found = import_arm(tmp_path / "arm.xml", fluid_density=998.0).model
    assert found.specimen.length == pytest.approx(0.16)
    assert found.specimen.density == pytest.approx(1000.0, rel=1e-6)
    assert found.value("elasticity", "E") == pytest.approx(0.02 * 0.02 / (0.25 * np.pi * 0.005**4), rel=1e-6)
    assert abs(found.gravity.angle) == pytest.approx(np.pi / 2)
    assert found.fluid.density == 998.0


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (chain(2), "hinges with a spring"),
        (chain(5).replace('axis="0 1 0"', 'axis="0 0 1"', 1), "different axes"),
        (chain(5).replace('type="hinge"', 'type="ball"', 1), "ball joints"),
        ("<mujoco>", "MuJoCo cannot read it"),
        (chain(5).replace('stiffness="0.02"', 'stiffness="1e99"', 1), "jnt_stiffness: is not finite, or huge"),
        (chain(5).replace('pos="0.02', 'pos="2e5', 1), "its hinges lie"),
    ],
)
def test_what_is_no_planar_arm_is_refused(tmp_path, text, says):
    file = tmp_path / "arm.xml"
    file.write_text(text)
    with pytest.raises(InputError, match=says):
        import_arm(file)
    shutil.rmtree(tmp_path)
