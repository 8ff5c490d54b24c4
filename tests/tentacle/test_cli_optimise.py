"""`tentacle optimise` from a file to its answer: it resumes, repeats itself, and refuses what it cannot use."""

import importlib.util
import json
import tomllib

import numpy as np
import pytest

from affine_model.swim import METHODS, OBJECTIVES, SILICONES, assumed_model, paper_cone
from affine_model.swim.polish import value_and_gradient
from tentacle.cli import main
from tentacle.cli import optimise as verb
from tentacle.cli._swim_work import search_tasks, search_work
from tentacle.errors import InputError
from tentacle.gait import Gait
from tentacle.io.model_file import write_model
from tentacle.io.waveform_file import read_waveform
from tentacle.model import Estimate

SPECIMEN = """[specimen]
section = "cone"
length_m = 0.21
base_radius_m = 0.0125
tip_radius_m = 0.001
density_kg_m3 = 1070
"""


@pytest.fixture
def arm(tmp_path):
    file = tmp_path / "arm.toml"
    file.write_text(SPECIMEN)
    return file


def optimise(arm, out, *more):
    quick = ("--evaluations", "96", "--no-reference", "--seed", "5")
    return main(["optimise", str(arm), "--out", str(out), *quick, *more])


def test_names_are_the_packages_own():
    assert set(verb.OBJECTIVES) == set(OBJECTIVES)
    assert set(verb.METHODS) == set(METHODS)
    assert set(verb.SILICONES) == set(SILICONES)


def test_answer_repeats_resumes_and_can_be_read(arm, tmp_path, capsys):
    assert optimise(arm, tmp_path / "one") == 0
    assert "times the best sine" in capsys.readouterr().out
    written = {file.name for file in (tmp_path / "one").iterdir()}
    assert written == {"gait.toml", "result.toml", "result.json", "session.rrd", "report.html", "search.jsonl"}
    gait = read_waveform(tmp_path / "one" / "gait.toml")
    assert isinstance(gait, Gait)
    result = tomllib.loads((tmp_path / "one" / "result.toml").read_text())
    assert result["waveform"]["alpha"] == list(gait.alpha)
    peaks = np.max(np.abs(gait(np.arange(0.0, 30.0, 1e-3))), axis=1)
    assert np.all(peaks <= np.array([np.pi / 3, 6.0, 120.0]) * 1.001)  # sampled at 2 ms when the limits were made sure

    # Killed while it wrote its second generation: the first is kept, the torn line cut, and the answer is the same.
    (tmp_path / "two").mkdir()
    lines = (tmp_path / "one" / "search.jsonl").read_text().splitlines()
    (tmp_path / "two" / "search.jsonl").write_text("\n".join([lines[0], lines[1], lines[2][:40]]))
    assert optimise(arm, tmp_path / "two") == 0
    for name in ("result.toml", "gait.toml", "search.jsonl"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()


def test_augmented_model_and_own_limits(tmp_path):
    model = assumed_model(paper_cone(0.14), "ecoflex-00-30").with_effect("skin_drag", C_t=Estimate.exact(0.05))
    write_model(model, tmp_path / "model.toml")
    (tmp_path / "limits.toml").write_text("[limits]\nangle_rad = 0.3\nhighest_frequency_hz = 1.5\n")
    limits = ("--limits", str(tmp_path / "limits.toml"), "--method", "ga", "--objective", "speed", "--robust", "2")
    assert optimise(tmp_path / "model.toml", tmp_path / "out", *limits) == 0
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    assert result["peaks"]["angle_rad"] <= 0.3 * 1.001
    assert max(result["waveform"]["alpha"][3:6]) <= 2 * np.pi * 1.5 + 1e-9


@pytest.mark.parametrize(
    ("limits", "says"),
    [
        ("[limits]\nangle_rad = -1\n", "angle_rad"),
        ("[limits]\nlowest_frequency_hz = 3\n", "bounds cross"),
        ("[limits]\nspeed_deg_s = 3\n", "speed_deg_s"),
        ("[limit]\nangle_rad = 1\n", "limits"),
    ],
)
def test_bad_limits_are_one_line(arm, tmp_path, capsys, limits, says):
    (tmp_path / "limits.toml").write_text(limits)
    assert optimise(arm, tmp_path / "out", "--limits", str(tmp_path / "limits.toml")) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert says in message
    assert not (tmp_path / "out").exists()


def test_a_servo_without_strength_is_one_line(arm, tmp_path, capsys):
    (tmp_path / "limits.toml").write_text("[limits]\ntorque_n_m = 1e-9\n")
    assert optimise(arm, tmp_path / "out", "--limits", str(tmp_path / "limits.toml")) == 2
    assert (
        capsys.readouterr()
        .err.strip()
        .endswith("tentacle: limits: no gait within the servo's limits swims forward; expected wider limits")
    )
    assert {file.name for file in (tmp_path / "out").iterdir()} == {"search.jsonl"}


def test_what_the_reference_lacks_leaves_out_its_check_alone(tmp_path, monkeypatch, capsys):
    def lacks(*_):
        raise InputError("no such parameter", field="tip_mass.reach", expected="one of mass")

    monkeypatch.setattr("validation.reference_swim.reference_speed", lacks)
    model = assumed_model(paper_cone(0.21), "dragon-skin-10")
    model = model.with_effect("current", U_x=Estimate.exact(0.02, "m/s"), U_y=Estimate.exact(-0.03, "m/s"))
    model = model.with_effect("viscoelasticity", g=Estimate.exact(0.3, "1"), tau=Estimate.exact(0.5, "s"))
    model = model.with_effect("tip_mass", mass=Estimate.exact(0.004, "kg"))
    model = model.with_effect("dry_friction", c_f=Estimate.exact(0.02, "rad"), slip=Estimate.exact(0.02, "rad"))
    write_model(model, tmp_path / "model.toml")
    assert main(["optimise", str(tmp_path / "model.toml"), "--out", str(tmp_path / "out"), "--evaluations", "50"]) == 0
    assert "MuJoCo: not checked; tip_mass.reach" in capsys.readouterr().out
    result = tomllib.loads((tmp_path / "out" / "result.toml").read_text())
    assert result["search"]["gain"] >= 1.0
    assert "reference" not in result


def test_soft_arm_is_refused_in_one_line(tmp_path, capsys):
    model = assumed_model(paper_cone(0.14), "dragon-skin-10").with_effect("elasticity", E=Estimate.exact(-1.0, "Pa"))
    write_model(model, tmp_path / "model.toml")
    assert optimise(tmp_path / "model.toml", tmp_path / "out") == 2
    assert "k(s) > 0" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.long
def test_robust_restarts_on_two_dask_workers_equal_those_here(arm, tmp_path):
    from distributed import LocalCluster

    settings = ("--robust", "2", "--restarts", "2", "--evaluations", "50")
    with LocalCluster(n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address="127.0.0.1:0") as cluster:
        address = ("--cluster", cluster.scheduler_address)
        assert optimise(arm, tmp_path / "dask", *settings, *address) == 0
    found = json.loads((tmp_path / "dask" / "result.json").read_text())
    assert found["search"]["seed"] in (5, 6)
    # Each worker is its own process with its own seed: this process finds the winner's gait to the last digit.
    model, limits = verb.read_arm(arm, verb.SILICONES[0]), verb.read_limits(None)
    common = {"objective": "thrust", "method": "cmaes", "evaluations": 50, "robust": 2}
    (task,) = search_tasks(model, limits, common, [found["search"]["seed"]])
    assert search_work(task)["gait"] == found["waveform"]["alpha"]


def test_polish_climbs_by_the_exact_gradient(arm, tmp_path, monkeypatch):
    asked = []

    def counted(*given):
        asked.append(given)
        return value_and_gradient(*given)

    monkeypatch.setattr("affine_model.swim.exact_gradient.exact_gradient", counted)
    assert optimise(arm, tmp_path / "one") == 0
    assert not asked
    assert optimise(arm, tmp_path / "two", "--polish") == 0
    assert asked
    before, after = (tomllib.loads((tmp_path / name / "result.toml").read_text()) for name in ("one", "two"))
    assert after["promise"]["thrust_n"] >= (1.0 - 1e-9) * before["promise"]["thrust_n"]


def test_polish_without_torch_is_one_line(arm, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    assert optimise(arm, tmp_path / "out", "--polish", "--device", "cpu") == 2
    assert "--polish" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_free_hull_swims_and_is_checked(arm, tmp_path):
    hull = tmp_path / "hull.toml"
    hull.write_text("[hull]\nmass_kg = 0.4\nyaw_inertia_kg_m2 = 6e-4\ndrag_along_n_s2_m2 = 1.0\n")
    out = tmp_path / "out"
    quick = ("--evaluations", "50", "--objective", "free", "--hull", str(hull), "--robust", "2")
    assert main(["optimise", str(arm), "--out", str(out), *quick]) == 0
    found = json.loads((out / "result.json").read_text())
    promise, reference = found["promise"], found["reference"]
    assert promise["free_speed_m_s"] >= 0.99 * found["sine"]["promise"]["free_speed_m_s"]
    # A symmetric gait goes straight but for what its start leaves; both models agree as in the paper's Table II.
    assert abs(promise["yaw_drift_rad_s"]) < 0.05
    assert reference["free_speed_m_s"] == pytest.approx(promise["free_speed_m_s"], rel=0.15)
    assert (out / "session.rrd").stat().st_size > 0


@pytest.mark.long
def test_restarts_keep_the_hull(arm, tmp_path):
    hull = tmp_path / "hull.toml"
    hull.write_text("[hull]\nmass_kg = 0.4\nyaw_inertia_kg_m2 = 6e-4\ndrag_along_n_s2_m2 = 1.0\n")
    speeds = []
    for number, more in enumerate(
        ((), ("--restarts", "1", "--hull", str(hull)), ("--restarts", "2", "--hull", str(hull)))
    ):
        out = tmp_path / str(number)
        assert optimise(arm, out, "--objective", "free", *more) == 0
        speeds.append(json.loads((out / "result.json").read_text())["promise"]["free_speed_m_s"])
    assert speeds[2] >= speeds[1]
    assert abs(speeds[1] / speeds[0] - 1.0) > 0.01  # another hull, another speed


def test_what_a_free_hull_cannot_have_is_refused(arm, tmp_path, capsys):
    hull = tmp_path / "hull.toml"
    hull.write_text("[hull]\nmass_kg = 0.4\n")
    for more, words in (
        (("--hull", str(hull)), "--objective free"),
        (("--objective", "free", "--hull", str(hull)), "yaw_inertia_kg_m2"),
    ):
        assert optimise(arm, tmp_path / "out", *more) == 2
        error = capsys.readouterr().err
        assert words in error
        assert error.count("\n") == 1
    if importlib.util.find_spec("torch") is not None:
        assert optimise(arm, tmp_path / "out", "--objective", "free", "--polish") == 2
        assert "exact gradient" in capsys.readouterr().err
