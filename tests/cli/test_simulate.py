import json
from pathlib import Path

import numpy as np
import pytest

from tentacle.cli import main
from tentacle.io.model_file import write_model
from tentacle.io.reading import read_recording
from tentacle.model import Estimate, Model
from tentacle.specimen import WATER, Cone, Specimen


@pytest.fixture
def model_file(tmp_path):
    model = Model(Specimen(Cone(0.0125, 0.0015), 0.14, 1070.0), WATER)
    model = model.with_effect("elasticity", E=Estimate.exact(2e5)).with_effect("damping", eta=Estimate.exact(300.0))
    file = tmp_path / "model.toml"
    write_model(model.with_effect("drag", C_perp=Estimate.exact(1.1)), file)
    return file


def simulate(model_file: Path, out: Path, *options: str) -> int:
    return main(["simulate", str(model_file), "--out", str(out), "--duration", "1", "--fps", "30", *options])


def test_a_folder_that_reads_back_with_the_truth_apart(model_file, tmp_path):
    truth = tmp_path / "truth.json"
    hide = ("--hide", "tip_mass=0.001", "--hide", "current=U_x:0.05,U_y:0", "--truth", str(truth))
    assert simulate(model_file, tmp_path / "run", *hide) == 0
    recording = read_recording(tmp_path / "run")
    assert recording.midline is not None
    assert recording.midline.xy.shape == (31, 41, 2)
    assert recording.declaration.specimen.tip_mass == 0.0
    assert "tip_mass = 0.001" not in (tmp_path / "run" / "recording.toml").read_text()
    hidden = json.loads(truth.read_text())["effects"]
    assert hidden == {"tip_mass": {"mass": 0.001}, "current": {"U_x": 0.05, "U_y": 0.0}}


def test_same_seed_same_files_and_another_seed_others(model_file, tmp_path):
    for name, seed in (("a", "3"), ("b", "3"), ("c", "4")):
        assert simulate(model_file, tmp_path / name, "--seed", seed, "--hide", "added_mass") == 0
    texts = [(tmp_path / name / "midline.csv").read_bytes() for name in "abc"]
    assert texts[0] == texts[1]
    assert texts[0] != texts[2]


def test_rrd_holds_the_same(model_file, tmp_path):
    assert simulate(model_file, tmp_path / "run") == 0
    assert simulate(model_file, tmp_path / "run.rrd") == 0
    folder, file = read_recording(tmp_path / "run").midline, read_recording(tmp_path / "run.rrd").midline
    assert folder is not None
    assert file is not None
    np.testing.assert_array_equal(folder.xy, file.xy)


def test_video_in_place_of_the_midline(model_file, tmp_path):
    assert simulate(model_file, tmp_path / "run", "--video", "clean", "--size", "320", "240") == 0
    recording = read_recording(tmp_path / "run")
    assert recording.video is not None
    assert recording.midline is None
    assert recording.declaration.camera is not None
    assert recording.declaration.camera.fps == pytest.approx(30.0)


def test_trials_are_sealed_and_go_on_where_they_stopped(model_file, tmp_path):
    out, sealed = tmp_path / "trials", tmp_path / "answers.jsonl"
    assert simulate(model_file, out, "--trials", "1", "--sealed", str(sealed)) == 0
    first = (out / "trial_000" / "midline.csv").stat().st_mtime_ns
    assert simulate(model_file, out, "--trials", "2", "--sealed", str(sealed)) == 0
    assert (out / "trial_000" / "midline.csv").stat().st_mtime_ns == first
    assert [json.loads(line)["trial"] for line in sealed.read_text().splitlines()] == [0, 1]
    assert sorted(folder.name for folder in out.iterdir()) == ["baseline", "trial_000", "trial_001"]
    for folder in out.iterdir():
        assert not any("effect" in file.read_text() for file in folder.iterdir())
    for name in ("recording.toml", "motor.csv"):  # the same for all: nothing to tell them apart by
        assert len({(folder / name).read_bytes() for folder in out.iterdir()}) == 1


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--hide", "gremlins"), "cannot be hidden"),
        (("--hide", "current=0.5"), "does not say of what"),
        (("--hide", "tip_mass=heavy"), "is not a number"),
        (("--fps", "0"), "0.0001 to 10000"),
        (("--fps", "1e-30"), "0.0001 to 10000"),
        (("--links", "0"), "2 to 1000"),
        (("--sine", "3", "5", "--servo-limits", "1", "20", "500"), "the motion reaches 3 rad"),
        (("--trials", "3"), "a place for their answers"),
        (("--video", "sepia"), "is not a look"),
    ],
)
def test_bad_input_is_one_line_and_nothing_written(model_file, tmp_path, capsys, options, words):
    import re

    assert simulate(model_file, tmp_path / "run", *options) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert re.search(words, error)
    assert not (tmp_path / "run").exists()


def test_young_in_megapascal_is_refused(model_file, tmp_path, capsys):
    model_file.write_text(model_file.read_text().replace("200000.0", "0.2"))
    assert simulate(model_file, tmp_path / "run") == 2
    assert "0.2 MPa is 2e5" in capsys.readouterr().err


def test_mujocos_own_camera_shows_the_arm_where_it_is(model_file, tmp_path):
    # In a process of its own: MuJoCo takes its backend when it is imported.
    import os
    import subprocess
    import sys

    import cv2

    options = ["--duration", "0.5", "--fps", "20", "--video", "mujoco", "--size", "320", "240"]
    command = [sys.executable, "-m", "tentacle", "simulate", str(model_file), "--out", str(tmp_path / "film"), *options]
    environment = {**os.environ, "MUJOCO_GL": "egl", "PYTHONPATH": str(Path(__file__).parents[2])}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False, timeout=120)
    if done.returncode != 0:
        pytest.skip(f"no offscreen backend: {done.stderr.strip().splitlines()[-1]}")
    assert main(["simulate", str(model_file), "--out", str(tmp_path / "run"), *options[:4], "--noise-mm", "0"]) == 0
    midline, film = read_recording(tmp_path / "run").midline, read_recording(tmp_path / "film")
    assert midline is not None
    assert film.video is not None
    assert film.declaration.camera is not None
    video = cv2.VideoCapture(str(film.video.path))
    good, picture = video.read()
    assert good
    dark = picture.mean(axis=2) < 128
    for x, y in film.declaration.camera.to_pixels(midline.xy[0, 8:36:4]):
        row = np.flatnonzero(dark[round(float(y))])
        # The row through a midline point cuts a tilted cone a little off its middle.
        assert 0.5 * (row[0] + row[-1]) == pytest.approx(float(x), abs=2.5)
