"""`tentacle replay`: what a rig's log alone says of the arm, by tracking its pictures and diagnosing them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from benchmarks._rig_optimise import DECLARED, HIDDEN
from tentacle.cli import main
from tentacle.waveform import Chirp
from tests.rig.filmed import filmed_run


@pytest.fixture
def log(tmp_path: Path) -> Path:
    path = tmp_path / "swim.rrd"
    filmed_run(DECLARED, HIDDEN, Chirp(0.4, 0.5, 2.0, 6.0), 6.0, path, {"kind": "chirp"})
    return path


@pytest.mark.long
def test_a_log_alone_is_tracked_and_diagnosed(log: Path, tmp_path: Path) -> None:
    """The arm carries a payload that nothing declares: it heads the ranking, and takes three quarters of the
    error away, whatever small effects of the film are named beside it.
    """
    assert main(["replay", str(log), "--out", str(tmp_path / "answer")]) == 0
    verdict = json.loads((tmp_path / "answer" / "verdict.json").read_text())
    assert verdict["ranking"][0]["effect"] == "tip_mass"
    assert verdict["error"]["after"]["midline_mm"] < verdict["error"]["before"]["midline_mm"] / 4.0


def test_driving_takes_no_options_of_the_diagnosis(
    log: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["replay", str(log), "--drive", str(tmp_path / "rig.toml"), "--out", str(tmp_path / "again")]
    assert main([*words, "--seed", "3"]) == 2
    assert "--seed" in capsys.readouterr().err
