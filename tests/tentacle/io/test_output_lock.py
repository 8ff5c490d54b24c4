"""Two commands on one output: the second is refused in one line and changes nothing; afterwards it runs."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tentacle.io.output_lock import owned_outputs
from tests.hostile.material import TEXTS
from tests.tentacle.io.lab_folder import CONE, MIDLINE, lab_folder

ROOT = Path(__file__).parents[3]
LONG = ("simulate", "model.toml", "--duration", "600", "--fps", "200")  # minutes
pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals")


def _start(arguments: tuple[str, ...], folder: Path) -> subprocess.Popen[str]:
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "TMPDIR": str(folder / "scratch")}
    return subprocess.Popen(
        [sys.executable, "-m", "tentacle", *arguments], cwd=folder, env=environment, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip


def _wait_for_lock(folder: Path) -> None:
    for _ in range(600):
        if any((folder / "scratch").glob("tentacle-locks-*/*")):
            return
        time.sleep(0.05)
    raise AssertionError("the first command took no lock")


@pytest.mark.parametrize(
    ("out", "second"),
    [
        ("out.rrd", ("import", "lab", "--out", "out.rrd")),
        ("out.rrd", ("track", "lab", "--out", "sub/../out.rrd")),
        ("out", ("simulate", "model.toml", "--duration", "1", "--out", "out/")),
        ("out", ("diagnose", "lab", "--out", "link")),
        ("out", ("identify", "lab", "--out", "out")),
    ],
    ids=lambda words: words if isinstance(words, str) else words[0],
)  # fmt: skip
def test_the_second_command_on_an_output_is_refused(out: str, second: tuple[str, ...], tmp_path: Path) -> None:
    for name in ("scratch", "sub"):
        (tmp_path / name).mkdir()
    (tmp_path / "link").symlink_to("out")
    (tmp_path / "model.toml").write_text(TEXTS["model.toml"])
    lab_folder(tmp_path / "lab", recording__toml=CONE, midline__csv=MIDLINE)
    first = _start((*LONG, "--out", out), tmp_path)
    try:
        _wait_for_lock(tmp_path)
        refused = _start(second, tmp_path)
        said, words = refused.communicate(timeout=60)
    finally:
        first.send_signal(signal.SIGTERM)
        first.communicate(timeout=30)
    assert (refused.returncode, said, words.count("\n")) == (2, "", 1)
    assert "is in use by another command" in words
    assert first.returncode == 143
    assert not (tmp_path / out).exists()
    assert not any((tmp_path / "scratch").glob("tentacle-locks-*/*"))


def test_a_killed_command_leaves_its_output_free(tmp_path: Path) -> None:
    (tmp_path / "scratch").mkdir()
    (tmp_path / "model.toml").write_text(TEXTS["model.toml"])
    lab_folder(tmp_path / "lab", recording__toml=CONE, midline__csv=MIDLINE)
    first = _start((*LONG, "--out", "out.rrd"), tmp_path)
    _wait_for_lock(tmp_path)
    first.kill()
    first.communicate()
    second = _start(("import", "lab", "--out", "out.rrd"), tmp_path)
    second.communicate(timeout=60)
    assert second.returncode == 0
    assert (tmp_path / "out.rrd").is_file()


def test_where_no_lock_can_be_made_the_command_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    taken = tmp_path / "taken"
    taken.write_text("a file")
    monkeypatch.setattr("tempfile.gettempdir", lambda: str(taken))
    with owned_outputs([tmp_path / "out"]), owned_outputs([tmp_path / "out"]):
        pass
