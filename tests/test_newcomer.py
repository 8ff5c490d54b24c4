"""A newcomer's first steps: the built wheel in a fresh environment without the extras, a video drawn by another tool.

The video is as short as a diagnosis takes it; the whole path with its times is benchmarks/first_hour.py.
"""

from __future__ import annotations

import importlib.util
import json
import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("tentacle", "affine_model", "mujoco_ref", "vision", "inference", "discovery", "validation", "viz", "rig")
EXTRAS = ("torch", "optuna", "serial", "distributed", "mkdocs", "nicegui")
DECLARATION = """\
[specimen]
section = "cone"
length_m = 0.14
base_radius_m = 0.0125
tip_radius_m = 0.003
density_kg_m3 = 1070
[fluid]
density_kg_m3 = 998
[camera]
fps = 30
m_per_px = 0.001
base_px = [160, 30]
arm_px = [0, 1]
"""
WITHOUT_EXTRAS = f"""\
import sys

class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {EXTRAS!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)

sys.meta_path.insert(0, Absent())
"""


def run(command: list[str | Path], folder: Path) -> subprocess.CompletedProcess[str]:
    """A command as the newcomer types it: nothing of this checkout is on any path."""
    shell = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    return subprocess.run(command, cwd=folder, env=shell, capture_output=True, text=True, timeout=900, check=False)


@pytest.fixture(scope="module")
def program(tmp_path_factory) -> Path:
    """`tentacle` of a fresh environment: the wheel, and this environment's libraries but for the extras."""
    for name in ("pip", "setuptools"):
        if importlib.util.find_spec(name) is None:
            pytest.skip(f"{name} is not here: no wheel can be built without a download")
    place = tmp_path_factory.mktemp("newcomer")
    source = place / "source"
    for name in PACKAGES:
        shutil.copytree(ROOT / name, source / name, ignore=shutil.ignore_patterns("__pycache__", "build"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source / name)
    offline = ["--no-deps", "--no-index", "--quiet", "--disable-pip-version-check"]
    build = [sys.executable, "-m", "pip", "wheel", *offline, "--no-build-isolation", "--wheel-dir", place, source]
    built = run(build, place)
    assert built.returncode == 0, built.stderr
    made = run([sys.executable, "-m", "venv", "--without-pip", place / "env"], place)
    assert made.returncode == 0, made.stderr
    python = place / "env" / "bin" / "python"
    site = next((place / "env" / "lib").glob("python*/site-packages"))
    (site / "libraries.pth").write_text(sysconfig.get_path("purelib"))
    (site / "sitecustomize.py").write_text(WITHOUT_EXTRAS)
    wheel = next(place.glob("*.whl"))
    installed = run([sys.executable, "-m", "pip", "--python", python, "install", *offline, wheel], place)
    assert installed.returncode == 0, installed.stderr
    where = run([python, "-c", "import tentacle; print(tentacle.__file__)"], place)
    assert where.stdout.startswith(str(site))
    return place / "env" / "bin" / "tentacle"


@pytest.fixture
def desk(tmp_path) -> Path:
    """What the newcomer brings: a video drawn with OpenCV alone, the servo's log, and the declaration."""
    import cv2

    folder = tmp_path / "my_arm"
    folder.mkdir()
    t, grain = np.arange(48) / 30, np.random.default_rng(0)
    theta = 0.35 * np.sin(2 * np.pi * 0.9 * t)
    writer = cv2.VideoWriter(str(folder / "video.avi"), cv2.VideoWriter.fourcc(*"MJPG"), 30.0, (320, 240))
    for angle in theta:
        picture = np.full((240, 320, 3), 215, np.uint8)
        along, across = np.array([-np.sin(angle), np.cos(angle)]), np.array([np.cos(angle), np.sin(angle)])
        base, tip = np.array([160.0, 30.0]), np.array([160.0, 30.0]) + 140 * along
        corners = [base + 12.5 * across, tip + 3 * across, tip - 3 * across, base - 12.5 * across]
        cv2.fillPoly(picture, [np.round(16 * np.array(corners)).astype(np.int32)], (45, 45, 45), cv2.LINE_AA, 4)
        # a sensor's noise: on a clean drawing the tracker sees the polygon's corners, and the diagnosis takes long
        noisy = picture + grain.normal(0.0, 5.0, (240, 320, 1))
        writer.write(np.clip(noisy, 0, 255).astype(np.uint8))
    writer.release()
    rows = [f"{a:.4f},{b:.6f},{b:.6f}" for a, b in zip(t, theta, strict=True)]
    (folder / "motor.csv").write_text("t_s,command_rad,angle_rad\n" + "\n".join(rows) + "\n")
    (folder / "recording.toml").write_text(DECLARATION)
    return tmp_path


def test_from_a_video_to_a_verdict(program, desk):
    size = ["--length", "0.14", "--base-radius", "0.0125", "--tip-radius", "0.003"]
    tracked = run([program, "track", "my_arm/video.avi", *size, "--out", "track.csv"], desk)
    assert tracked.returncode == 0, tracked.stderr
    # the camera that recording.toml asks for: 1 mm a pixel, the base where it was drawn
    (camera,) = (line for line in tracked.stdout.splitlines() if line.startswith("[camera]"))
    found = dict(part.split(" = ") for part in camera.split("  ")[1:])
    assert float(found["m_per_px"]) == pytest.approx(1e-3, rel=0.02)
    np.testing.assert_allclose(json.loads(found["base_px"]), [160, 30], atol=2)  # px; the clamp hides nothing here
    for command in (
        "import my_arm --out my_arm.rrd",
        "figure 3 my_arm.rrd --out steps.svg",
        "diagnose my_arm.rrd --out answer",
    ):
        done = run([program, *command.split()], desk)
        assert done.returncode == 0, f"{command}\n{done.stderr}"
    assert "largest contour" in (desk / "steps.svg").read_text()
    assert b"my_arm" in (desk / "my_arm.rrd").read_bytes()
    verdict = json.loads((desk / "answer" / "verdict.json").read_text())
    assert verdict["verdict"] in ("nothing_missing", "effect", "group", "unknown")
    assert (verdict["verdict"] in ("effect", "group")) == bool(verdict["effects"])
    error = verdict["error"]  # a rod that does not bend is no model's arm, but the tracker holds it to the drawing
    assert 0.0 < error["floor"]["midline_mm"] < 0.5 * error["before"]["midline_mm"] < 1.0
    report = (desk / "answer" / "report.html").read_text()
    assert report.lower().startswith("<!doctype html>")
    assert "<svg" in report
    assert len(report) < 3e6  # one file that is mailed


@pytest.mark.parametrize(
    ("command", "extra"),
    [
        ("rig ports", "rig"),
        ("app recordings --no-browser", "app"),
        ("compare model.toml --out out --cluster tcp://127.0.0.1:1", "cluster"),
    ],
)
def test_what_only_an_extra_brings_is_named_in_a_line(program, desk, command, extra):
    from tentacle.io.model_file import write_model
    from tentacle.model import Estimate, Model
    from tentacle.specimen import WATER, Cone, Specimen

    model = Model(Specimen(Cone(0.0125, 0.003), 0.14, 1070.0), WATER)
    write_model(model.with_effect("elasticity", E=Estimate.exact(2e5, "Pa")), desk / "model.toml")
    done = run([program, *command.split()], desk)
    assert done.returncode == 2
    assert done.stderr.strip().splitlines()[-1].endswith(f"pip install 'tentacle-twin[{extra}]'")
    assert "Traceback" not in done.stderr
