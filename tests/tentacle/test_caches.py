"""Caches: torn ones are rebuilt, another user's are refused, and none is open to others."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from tentacle import private_cache
from tentacle.errors import InputError
from tentacle.io.video_store import store_frames, store_video

DOUBLED = """
from tentacle.compiled import njit

@njit(cache=True)
def doubled(x):
    return 2.0 * x

print(doubled(21.0))
"""


def run_doubled(folder: Path) -> str:
    program = folder / "doubled.py"
    if not program.exists():  # numba's cache goes by its age
        program.write_text(DOUBLED)
    environment = {**os.environ, "PYTHONPATH": str(Path.cwd())}
    ran = subprocess.run([sys.executable, program], env=environment, capture_output=True, text=True, check=True)
    return ran.stdout


@pytest.mark.parametrize("suffix", ["nbi", "nbc"])
def test_a_torn_compiled_function_is_compiled_anew(tmp_path: Path, suffix: str) -> None:
    assert run_doubled(tmp_path).startswith("42.0")
    (torn,) = (tmp_path / "__pycache__").glob(f"*.{suffix}")
    whole = torn.read_bytes()
    torn.write_bytes(whole[: len(whole) // 2] + bytes(len(whole) - len(whole) // 2))
    assert run_doubled(tmp_path).startswith("42.0")
    assert torn.read_bytes()[-32:] != bytes(32)  # mended, and so quick the next time


def test_a_change_in_another_file_of_the_room_is_compiled_in(tmp_path: Path) -> None:
    room = tmp_path / "room"
    room.mkdir()
    (room / "__init__.py").touch()
    head = "from tentacle.compiled import njit\n"
    (room / "taken_in.py").write_text(head + "@njit(cache=True)\ndef more(x):\n    return x + 1.0\n")
    (room / "taker.py").write_text(
        head + "from room.taken_in import more\n@njit(cache=True)\ndef twice(x):\n    return 2.0 * more(x)\n"
    )
    environment = {**os.environ, "PYTHONPATH": f"{Path.cwd()}{os.pathsep}{tmp_path}"}

    def found() -> str:
        program = "from room.taker import twice; print(twice(1.0))"
        return subprocess.run(
            [sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True
        ).stdout.strip()

    assert found() == "4.0"
    (room / "taken_in.py").write_text(head + "@njit(cache=True)\ndef more(x):\n    return x + 3.0\n")
    assert found() == "8.0"


@pytest.mark.parametrize("of", ["room", "other_room"])
def test_a_class_that_has_another_name_now_is_compiled_anew(tmp_path: Path, of: str) -> None:
    for room in ("room", "other_room"):
        (tmp_path / room).mkdir()
        (tmp_path / room / "__init__.py").touch()
    environment = {**os.environ, "PYTHONPATH": f"{Path.cwd()}{os.pathsep}{tmp_path}"}
    for name in ("Size", "Extent"):
        (tmp_path / of / "sizes.py").write_text(
            f"from typing import NamedTuple\nclass {name}(NamedTuple):\n    x: float\n"
        )
        (tmp_path / "room" / "taker.py").write_text(
            "from tentacle.compiled import njit\n@njit(cache=True)\ndef twice(size):\n    return 2.0 * size.x\n"
        )
        program = f"from {of}.sizes import {name}\nfrom room.taker import twice\nprint(twice({name}(1.5)))"
        ran = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True)
        assert ran.stdout.strip() == "3.0", ran.stderr


def test_a_cache_folder_is_private(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TENTACLE_CACHE", str(tmp_path))
    (tmp_path / "videos").mkdir(mode=0o777)
    assert stat.S_IMODE(private_cache.cache_folder("videos").stat().st_mode) == 0o700


def test_a_cache_folder_of_another_user_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TENTACLE_CACHE", str(tmp_path))
    monkeypatch.setattr(os, "geteuid", lambda: os.getuid() + 1)
    with pytest.raises(InputError, match="another user"):
        private_cache.cache_folder("kernels")


def test_without_a_place_for_it_a_cache_lasts_for_the_process(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("TENTACLE_CACHE", str(tmp_path / "file"))
    assert private_cache.cache_folder("kernels") == private_cache.cache_folder("kernels")
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_a_torn_video_in_the_cache_is_written_again() -> None:
    file = store_video(b"film", ".mp4")
    file.write_bytes(b"flim")
    assert store_video(b"film", ".mp4").read_bytes() == b"film"
    folder = store_frames([b"one", b"two"])
    (folder / "00001.png").write_bytes(b"twp")
    assert [f.read_bytes() for f in sorted(store_frames([b"one", b"two"]).iterdir())] == [b"one", b"two"]


def test_the_oldest_videos_leave_a_cache_over_its_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    old, fresh = store_video(b"an old one", ".mp4"), store_video(b"a fresh one", ".mp4")
    os.utime(old, (0, 0))
    monkeypatch.setenv("TENTACLE_VIDEOS_GB", "1e-9")
    store_video(b"another", ".mp4")
    assert not old.exists()
    assert fresh.exists()
