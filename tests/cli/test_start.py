"""How the command starts in odd surroundings: without standard streams, with torn compiled modules, on a full disk."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tentacle import compiled_modules
from tentacle.compiled_modules import remove_torn_modules, write_no_torn_modules

ROOT = Path(__file__).parents[2]
COMMAND = f"{sys.executable} -m tentacle"


def _ran(shell: str, folder: Path, tree: Path = ROOT) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(tree)}
    for name in ("PYTHONDONTWRITEBYTECODE", "PYTHONUNBUFFERED"):
        environment.pop(name, None)
    return subprocess.run(
        ["bash", "-c", shell], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


@pytest.mark.skipif(sys.platform == "win32", reason="the shell's closed streams")
@pytest.mark.parametrize("closed", [">&-", "2>&-", "<&- >&- 2>&-"])
def test_a_command_without_standard_streams_does_what_it_does_with_them(closed: str, tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text("x = 1\n")
    ended = _ran(f"{COMMAND} check a.toml {closed}", tmp_path)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert [file.name for file in tmp_path.iterdir()] == ["a.toml"]
    assert (tmp_path / "a.toml").read_text() == "x = 1\n"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="Linux")
def test_a_full_standard_output_is_named(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text("x = 1\n")
    ended = _ran(f"{COMMAND} check a.toml > /dev/full", tmp_path)
    assert (ended.returncode, ended.stderr) == (2, "tentacle: the standard output: No space left on device\n")


@pytest.mark.parametrize("module", ["tentacle/cli/__init__", "rig/soundness"])
def test_torn_compiled_modules_are_removed_and_made_again(module: str, tmp_path: Path) -> None:
    """All at once: the next run of the command works. One is read before the command line is there, one after."""
    tree = tmp_path / "tree"
    for room in ("tentacle", "rig"):
        shutil.copytree(ROOT / room, tree / room, ignore=shutil.ignore_patterns("__pycache__", "firmware"))
    (tree / "a.toml").write_text("x = 1\n")
    assert _ran(f"{COMMAND} check a.toml", tree, tree).returncode == 0
    path = tree / module
    torn = [next((path.parent / "__pycache__").glob(f"{path.name}.*.pyc"))]
    torn += [next((tree / "rig" / "__pycache__").glob(f"{name}.*.pyc")) for name in ("run_file", "run_layout")]
    for file in torn:
        os.truncate(file, 200)
    first, second = (_ran(f"{COMMAND} check a.toml", tree, tree) for _ in range(2))
    assert (first.returncode, len(first.stderr.splitlines())) == (2, 1)
    assert "3 such files are removed" in first.stderr
    assert (second.returncode, second.stderr) == (0, "")


def test_a_sound_compiled_module_stays(tmp_path: Path) -> None:
    cache = tmp_path / "package" / "__pycache__"
    cache.mkdir(parents=True)
    torn = cache / "torn.pyc"
    torn.write_bytes(bytes(20))
    compiled = Path(compiled_modules.__cached__)
    sound = shutil.copy(compiled, cache / "sound.pyc")
    assert "1 such files" in remove_torn_modules(torn)
    assert list(cache.iterdir()) == [Path(sound)]


def test_on_a_disk_that_is_nearly_full_no_compiled_module_is_written(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    write_no_torn_modules()
    assert not sys.dont_write_bytecode
    monkeypatch.setattr(compiled_modules, "_room", lambda _place: 5000.0)
    write_no_torn_modules()
    assert sys.dont_write_bytecode
