"""The front door: verbs are found, help is quick and whole, bad input is one line and exit code 2."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tentacle.cli import build_parser, main, verb_names
from tentacle.io.recording_rrd import write_rrd
from tests.tentacle.io.lab_folder import CONE, MIDLINE, lab_folder
from tests.tentacle.io.test_bad_import_folder import BAD
from tests.tentacle.io.test_import_folder import random_recording

ROOT = Path(__file__).parents[2]
HEAVY = ("numpy", "scipy", "mujoco", "cv2", "torch", "rerun", "numba", "matplotlib", "av", "sympy", "pyarrow", "rich")


def loaded_by(code: str) -> list[str]:
    """The heavy libraries that a fresh interpreter has loaded after some code."""
    ask = f"{code}\nimport sys\nprint([name for name in {HEAVY!r} if name in sys.modules])"
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run([sys.executable, "-c", ask], env=environment, capture_output=True, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1].replace("'", '"'))


def test_importing_the_package_and_building_the_parser_load_no_heavy_library() -> None:
    assert loaded_by("import tentacle") == []
    assert loaded_by("from tentacle.cli import build_parser; build_parser().format_help()") == []


def test_every_verb_says_in_a_line_what_it_does() -> None:
    text = build_parser().format_help()
    assert {"import", "data", "view"} <= set(verb_names())
    for name in verb_names():
        assert f"\n    {name}" in text


def test_help_that_cannot_be_written_is_told(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with Path("/dev/full").open("w", buffering=1) as full:
        monkeypatch.setattr("sys.stdout", full)
        assert main(["--help"]) == 2
    assert capsys.readouterr().err == "tentacle: the standard output: No space left on device\n"


@pytest.mark.parametrize("verb", verb_names())
def test_every_verb_has_a_help_page(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main([verb, "--help"])
    assert ended.value.code == 0
    assert f"usage: tentacle {verb}" in capsys.readouterr().out


def test_an_import_is_stored_and_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = lab_folder(tmp_path / "lab", recording__toml=CONE, midline__csv=MIDLINE)
    assert main(["import", str(folder), "--out", str(tmp_path / "lab.rrd")]) == 0
    assert "midline: 2 points, 2 samples, 0 to 0.1 s, 10 Hz" in capsys.readouterr().out
    assert main(["import", str(tmp_path / "lab.rrd"), "--out", str(tmp_path / "again.rrd"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["name"] == "lab"


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_one_line_and_exit_code_2_and_nothing_is_written(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files, said = BAD[name]
    folder = lab_folder(tmp_path / "lab", **files)
    before = sorted(tmp_path.rglob("*"))
    assert main(["import", str(folder), "--out", str(tmp_path / "lab.rrd")]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.count("\n") == 1
    assert printed.err.startswith("tentacle: ")
    assert said in printed.err
    assert sorted(tmp_path.rglob("*")) == before


def test_a_recovered_recording_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_rrd(random_recording(), tmp_path / "whole.rrd")
    content = (tmp_path / "whole.rrd").read_bytes()
    (tmp_path / "cut.rrd").write_bytes(content[: int(0.7 * len(content))])
    assert main(["import", str(tmp_path / "cut.rrd"), "--out", str(tmp_path / "again.rrd")]) == 0
    assert "note: cut_off: the file is cut off" in capsys.readouterr().out


@pytest.mark.parametrize("out", ["no_folder/lab.rrd", "lab.csv"])
def test_an_unusable_output_is_one_line(out: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = lab_folder(tmp_path / "lab", recording__toml=CONE, midline__csv=MIDLINE)
    assert main(["import", str(folder), "--out", str(tmp_path / out)]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_ctrl_c_ends_with_130() -> None:
    script = (
        "import argparse, sys, time, types\n"
        "import tentacle.cli as cli\n"
        "def run(_):\n    print('waiting', flush=True)\n    time.sleep(60)\n"
        "parser = argparse.ArgumentParser()\n"
        "parser.set_defaults(run=run)\n"
        "cli.build_parser = lambda: parser\n"
        "sys.exit(cli.main([]))\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    # A background job of a shell is started with SIGINT ignored, and its children inherit that.
    script = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n" + script
    with subprocess.Popen(
        [sys.executable, "-c", script], env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "waiting\n"
        time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=30)
    assert process.returncode == 130
    assert errors == "tentacle: stopped\n"
