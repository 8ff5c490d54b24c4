"""What commands print: names cannot command a terminal, and an output that is lost costs no file."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

import tentacle.cli
from tentacle.cli._error_words import os_words
from tentacle.cli._output import cell, remark, say, show
from tests.hostile.material import TEXTS
from tests.tentacle.io.lab_folder import CONE, MIDLINE, lab_folder

ROOT = Path(__file__).parents[2]
HOME = Path(tentacle.cli.__file__).parent
FILES = sorted([*HOME.glob("*.py"), *(HOME / "pages").glob("*.py")])
NAME = "odd\x1b]0;title\x07\x1b[31m[/red]\n\u202ename"
WRITTEN_OUT = "odd\\x1b]0;title\\x07\\x1b[31m[/red]\\n\\u202ename"
VERBS = {
    "out.rrd": ("import", "lab", "--out"),
    "out": ("export", "model.toml", "--out"),
    "film": ("render", "--seed", "1", "--seconds", "0.2", "--size", "160", "120", "--out"),
    "new": ("new", "--length", "0.1", "--base-radius", "0.01", "--tip-radius", "0.005", "--density", "1070",
            "--fluid-density", "998"),
    "board.png": ("calibrate", "--print-board"),
    "figure.svg": ("figure", "9", "--model", "model.toml", "--out"),
}  # fmt: skip


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_everything_is_printed_in_one_place(file: Path) -> None:
    """`print` and rich's own output would let a name through. A script and the help are the program's own words."""
    allowed = {"_output": {"print"}, "__init__": {"print"}}.get(file.stem, set())
    calls = [node.func for node in ast.walk(ast.parse(file.read_text())) if isinstance(node, ast.Call)]
    used = {ast.unparse(function) for function in calls}
    assert {name for name in used if name == "print" or name.endswith(("Console().print", ".stdout.write"))} <= allowed


def test_a_name_is_written_out(capsys: pytest.CaptureFixture[str]) -> None:
    from rich.table import Table

    say(f"wrote {NAME}", Path(NAME))
    remark(NAME)
    table = Table()
    table.add_column("name")
    table.add_row(cell(NAME))
    show(table, width=120)
    printed = capsys.readouterr()
    assert printed.out.startswith(f"wrote {WRITTEN_OUT}\n{WRITTEN_OUT}\n")
    assert printed.err == f"tentacle: {WRITTEN_OUT}\n"
    assert f" {WRITTEN_OUT} " in printed.out
    assert not {"\x1b", "\x07", "\u202e"} & set(printed.out + printed.err)


def test_an_error_names_the_file_that_was_to_be_written() -> None:
    """Of a copy the second one, and what is not finished yet by the name that it was to have."""
    full = OSError(28, "No space left on device", "/tmp/made/video.mp4", None, "run/.out.partial-k3_x9/video.mp4")
    assert os_words(full) == "run/out/video.mp4: No space left on device"
    assert os_words(FileNotFoundError(2, "No such file", "a.toml")) == "a.toml: No such file"


def _ran(shell: str, folder: Path) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    environment.pop("PYTHONUNBUFFERED", None)
    return subprocess.run(
        ["bash", "-o", "pipefail", "-c", shell], cwd=folder, env=environment, capture_output=True, text=True,
        check=False,
    )  # fmt: skip


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="Linux")
@pytest.mark.parametrize("output", ["> /dev/full", "| true"], ids=["full", "gone"])
@pytest.mark.parametrize("out", VERBS)
def test_a_lost_output_costs_no_file(out: str, output: str, tmp_path: Path) -> None:
    """A full disk under the standard output is exit code 2 and one line; a reader that has gone is none of our errors.
    The files are there in both cases.
    """
    lab_folder(tmp_path / "lab", recording__toml=CONE, midline__csv=MIDLINE)
    (tmp_path / "model.toml").write_text(TEXTS["model.toml"])
    ended = _ran(f"{sys.executable} -m tentacle {' '.join(VERBS[out])} {out} {output}", tmp_path)
    told = "tentacle: the standard output: No space left on device\n"
    assert (ended.returncode, ended.stderr) == ((2, told) if output == "> /dev/full" else (0, ""))
    assert (tmp_path / out).exists()
    assert [path.name for path in tmp_path.iterdir() if "partial" in path.name] == []
