"""The identified arm as a script of PyElastica or SoRoMoX: what is written, where neither is installed."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from mujoco_ref.export.arm_numbers import arm_numbers
from mujoco_ref.export.script import PROGRAMS, export_script
from tentacle.cli import main
from tentacle.io.model_file import write_model
from tests.mujoco_ref.arms import model_of, swimming_model

EFFECTS = {
    "soft_spot": {"depth": 0.3, "s0": 0.3},
    "viscoelasticity": {"g": 0.3, "tau": 0.2},
    "servo_lag": {"tau": 0.02},
}


@pytest.fixture
def model_file(tmp_path):
    write_model(swimming_model(**EFFECTS), tmp_path / "model.toml")
    return str(tmp_path / "model.toml")


@pytest.mark.parametrize("to", PROGRAMS)
def test_a_script_compiles_and_needs_nothing_of_this_project(to):
    made = export_script(swimming_model(), to)
    compile(made.text, made.program.script, "exec")
    assert "import tentacle" not in made.text
    assert "from tentacle" not in made.text
    assert "mujoco" not in made.text


@pytest.mark.parametrize("to", PROGRAMS)
def test_what_is_left_out_is_named_in_the_output_and_in_the_script(to, model_file, tmp_path, capsys):
    assert main(["export", model_file, "--to", to, "--out", str(tmp_path / "arm")]) == 0
    said = capsys.readouterr().out
    script = (tmp_path / "arm" / PROGRAMS[to].script).read_text()
    for line in ("leaves out viscoelasticity: the script has no law for it.", "leaves out servo_lag: the command"):
        assert line in said
        assert line in script.split('"""')[0]
    assert (tmp_path / "arm" / "arm.json").exists()


def test_the_numbers_are_the_model_s():
    model = swimming_model(added_mass={"C_a": 0.8}, buoyancy={"density_error": 30.0}, tip_mass={"mass": 0.002})
    numbers, specimen = json.loads(json.dumps(arm_numbers(model))), model.specimen
    along = {name: np.array(values) for name, values in numbers["along"].items()}
    second = specimen.section.second_moment(along["s"])
    # The same formulas by another way: exact but for rounding.
    assert np.allclose(along["bending_stiffness"], 2e5 * second, rtol=1e-12)
    assert np.allclose(along["bending_damping"], 300.0 * second, rtol=1e-12)
    assert numbers["density"] == pytest.approx(specimen.density + 30.0, rel=1e-12)
    assert numbers["water"]["C_a"] == 0.8
    assert numbers["bodies"] == [
        {"mass": 0.002, "reach": 0.0, "drop": 0.0, "volume": pytest.approx(0.002 / specimen.tip_mass_density)}
    ]
    mass = numbers["density"] * specimen.length * along["area"].mean()
    # Midpoint rule with 200 places on a parabola: 1 / (24 200^2) of its second derivative.
    assert mass == pytest.approx(replace(specimen, density=numbers["density"]).mass, rel=1e-4)


def test_a_soft_spot_and_the_affine_law_are_in_the_stiffness():
    affine = arm_numbers(model_of(swimming_model().specimen, elasticity={"E": 0.0, "k0": 0.02, "k1": -0.01}))
    s = np.array(affine["along"]["s"])
    # k per unit of c = curvature times length: E I = k L.
    assert np.allclose(affine["along"]["bending_stiffness"], (0.02 - 0.01 * s) * 0.14, rtol=1e-12)
    soft, plain = (arm_numbers(swimming_model(**own)) for own in ({"soft_spot": EFFECTS["soft_spot"]}, {}))
    ratio = np.array(soft["along"]["bending_stiffness"]) / np.array(plain["along"]["bending_stiffness"])
    assert ratio.min() == pytest.approx(0.7, abs=1e-3)  # its depth, at a place of the table within 1/400 of its middle


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--links", "12"], "--links: does not go with --to soromox"),
        (["--python", "/nowhere/python"], "--python: No such file"),
        (["--recording", "/nowhere/run.rrd"], "run.rrd"),
    ],
)
def test_a_bad_request_ends_with_one_line(model_file, tmp_path, capsys, arguments, says):
    assert main(["export", model_file, "--to", "soromox", "--out", str(tmp_path / "arm"), *arguments]) == 2
    said = capsys.readouterr().err
    assert says in said
    assert said.count("\n") == 1
    assert not (tmp_path / "arm").exists()


def test_a_bad_model_and_a_folder_that_cannot_be_written_end_with_one_line(model_file, tmp_path, capsys):
    (tmp_path / "bad.toml").write_text("order = 'two'\n")
    assert main(["export", str(tmp_path / "bad.toml"), "--to", "pyelastica", "--out", str(tmp_path / "arm")]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    (tmp_path / "file").write_text("")
    for out in ("file", "file/arm"):
        assert main(["export", model_file, "--to", "pyelastica", "--out", str(tmp_path / out)]) == 2
        assert capsys.readouterr().err.count("\n") == 1
    assert sorted(file.name for file in tmp_path.iterdir()) == ["bad.toml", "file", "model.toml"]
    assert main(["export", model_file, "--python", "python3", "--out", str(tmp_path / "arm")]) == 2
    assert "does not go with --to mjcf" in capsys.readouterr().err
