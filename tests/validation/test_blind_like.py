"""Blind trials like a recording of one's own, and a diagnosis whose confidence is theirs."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from discovery.calibration import read_calibration
from tentacle.cli import main
from tentacle.io.recording_rrd import write_rrd
from tests.made_recordings import record

FLAT = "".join(
    f"\n[{verdict}]\ntrials = 7\nstated = [0.0, 1.0]\nright = [0.3, 0.3]\n"
    for verdict in ("nothing_missing", "effect", "group", "unknown")
)


@pytest.fixture(scope="module")
def own(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("own") / "own.rrd"
    write_rrd(replace(record({("current", "U_x"): 0.03}, seconds=6.0), name="own"), file)
    return file


@pytest.mark.long
def test_trials_like_a_recording_say_what_they_share_with_it(own: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    asked = ["blind-trial", "2", "--like", str(own), "--kinds", "null", "--workers", "2", "--out", str(out)]
    assert main(asked) == 0
    report = (out / "report.html").read_text()
    for words in ("Trials like own", "Shared by all trials", "points of the midline", "6 s", "SHA-256"):
        assert words in report
    trials = json.loads((out / "results.json").read_text())["trials"]
    assert [trial["kind"] for trial in trials] == ["null", "null"]
    assert {trial["seen"] for trial in trials} == {"midline"}
    calibration = read_calibration(out / "calibration.toml")
    assert "--like" in calibration.made
    assert set(calibration.tables) == {trial["verdict"] for trial in trials}


def test_a_confidence_is_that_of_the_trials_given(own: Path, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    file = tmp_path / "calibration.toml"
    file.write_text('made = "seven trials"\n' + FLAT)
    assert main(["diagnose", str(own), "--calibration", str(file), "--out", str(tmp_path / "out"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["confidence"] == pytest.approx(0.3)
    report = (tmp_path / "out" / "report.html").read_text()
    assert "7 blind trials of this verdict (seven trials)" in report
    assert "calibration.toml" in report  # with its hash, among what it was made from


@pytest.mark.parametrize(
    ("more", "named"),
    [
        (["--like", "nowhere.rrd"], "nowhere.rrd"),
        (["--like", "own", "--video-share", "0.5"], "--video-share"),
        (["--like", "own", "--plant", "chain"], "--plant"),
        (["--plant", "tank"], "tank"),
    ],
)
def test_bad_arguments_are_one_line_and_exit_2(own, tmp_path, capsys, more, named):
    more = [str(own) if word == "own" else word for word in more]
    assert main(["blind-trial", "3", *more, "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err.strip()
    assert named in error
    assert "\n" not in error
    assert not (tmp_path / "out").exists()


def test_a_bad_calibration_is_refused_before_anything_is_read(tmp_path, capsys):
    file = tmp_path / "calibration.toml"
    file.write_text(FLAT)
    assert main(["diagnose", "nowhere", "--calibration", str(file), "--out", str(tmp_path / "out")]) == 2
    assert "made: missing" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
