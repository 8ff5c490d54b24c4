"""Under any limit of memory a command is right, or ends in one line: native code that aborts is no abort of ours."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.hostile.material import TEXTS
from tests.tentacle.io.lab_folder import CONE, MIDLINE, lab_folder

ROOT = Path(__file__).parents[2]
MB = 10**6
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="ulimit -v")


def _start(arguments: tuple[str, ...], folder: Path, allowed: int) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "tentacle", *arguments], cwd=folder, text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)}, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (allowed, allowed)),
    )  # fmt: skip


@pytest.mark.parametrize("allowed", [150, 300, 500, 700, 1000, 1400, 2000, 8000])
def test_an_import_is_right_or_one_line(allowed: int, tmp_path: Path) -> None:
    lab_folder(tmp_path / "lab", recording__toml=CONE, midline__csv=MIDLINE)
    ended = _start(("import", "lab", "--out", "out.rrd"), tmp_path, allowed * MB)
    said, words = ended.communicate(timeout=120)
    if ended.returncode == 0:
        assert (words, (tmp_path / "out.rrd").is_file()) == ("", True)
        assert "midline: 2 points" in said
    else:
        assert (ended.returncode, words.count("\n"), words[:10]) == (2, 1, "tentacle: "), words
        assert sorted(path.name for path in tmp_path.iterdir()) == ["lab"]
    assert ended.returncode == (0 if allowed == 8000 else ended.returncode)


def test_a_signal_ends_a_command_under_a_limit(tmp_path: Path) -> None:
    (tmp_path / "model.toml").write_text(TEXTS["model.toml"])
    long = ("simulate", "model.toml", "--duration", "600", "--fps", "200", "--out", "out.rrd")
    started = _start(long, tmp_path, 8000 * MB)
    time.sleep(3.0)
    started.send_signal(signal.SIGTERM)
    _, words = started.communicate(timeout=30)
    assert (started.returncode, words) == (143, "tentacle: stopped\n")
    assert [path.name for path in tmp_path.iterdir()] == ["model.toml"]
