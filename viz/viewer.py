"""Opening recordings: the native viewer, or a picture without a screen. The web page is in page.py."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, TYPE_CHECKING

from tentacle.errors import InputError
from tentacle.io.plain_file import require_plain
from tentacle.io.written_file import written_file

if TYPE_CHECKING:
    from rerun.experimental import ViewerClient

LOOPBACK = "127.0.0.1"
VIEWER_PATIENCE = 60.0  # s for the viewer to come up: 0.2 on a free computer, but its program has 290 MB to be read
INSTALL_VULKAN = "apt-get install mesa-vulkan-drivers (a software Vulkan driver) and try again"


def viewer_program() -> str:
    """The rerun program that belongs to this Python, else the one on PATH. Raises InputError where there is none."""
    beside = Path(sys.executable).with_name("rerun")
    program = str(beside) if beside.exists() else shutil.which("rerun")
    if program is None:
        raise InputError("the Rerun viewer is not installed", expected="pip install rerun-sdk")
    return program


def viewer_environment() -> dict[str, str]:
    """The environment of a viewer that we start: it sends no usage statistics, unless TENTACLE_VIEWER_TELEMETRY=1.

    Rerun sends none where CI is set; it has no other setting than one for all of the user's programs.
    """
    if os.environ.get("TENTACLE_VIEWER_TELEMETRY") == "1":
        return dict(os.environ)
    return {**os.environ, "CI": "1"}


def require_recordings(files: Sequence[Path]) -> list[Path]:
    """The files as absolute paths. Raises InputError for one that is missing or no .rrd."""
    for file in files:
        require_plain(file, "an .rrd recording")
        if not file.stat().st_size:
            raise InputError("is empty", file=file, expected="an .rrd recording")
        with file.open("rb") as stream:
            if not stream.read(4).startswith(b"RR"):
                raise InputError("is not a Rerun recording", file=file, expected="an .rrd recording")
    return [file.resolve() for file in files]


@contextmanager
def running(arguments: Sequence[str], said: IO[bytes] | None = None) -> Iterator[subprocess.Popen[bytes]]:
    """The viewer's program on this machine only, with what it starts itself; all of it ends with the block.

    It listens on ports that nobody else has. The program is a script that starts another program. To end the first
    alone would leave the second one running, so both are in a separate group.
    """
    command = [viewer_program(), "--bind", LOOPBACK, *arguments]
    process = subprocess.Popen(command, stdout=said, stderr=said, start_new_session=True, env=viewer_environment())
    try:
        yield process
    finally:
        end_group(process)


def end_group(process: subprocess.Popen[bytes], within: float = 5.0) -> None:
    """Ends a process and its group, first by SIGTERM and after some seconds by SIGKILL; returns when all have ended."""
    for hard in (False, True):  # one that is busy with a page does not hear the first order
        with suppress(ProcessLookupError):
            _end(process, hard)
        deadline = time.monotonic() + within
        while time.monotonic() < deadline:
            if process.poll() is not None and not _has_members(process.pid):
                return
            time.sleep(0.02)


def _has_members(group: int) -> bool:
    """Whether a process of the group still runs: a process may be outlived by its children."""
    if sys.platform == "win32":
        return False
    try:
        os.killpg(group, 0)
    except (ProcessLookupError, PermissionError):
        return False
    return True


def _end(process: subprocess.Popen[bytes], hard: bool) -> None:
    """Ends the group of a process; on Windows, which has no groups of this kind, the process alone."""
    if sys.platform == "win32":
        process.kill() if hard else process.terminate()
    else:
        os.killpg(process.pid, signal.SIGKILL if hard else signal.SIGTERM)


def has_screen() -> bool:
    """Whether a window can be opened."""
    return sys.platform in ("win32", "darwin") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def require_screen() -> None:
    """Raises InputError, with the other ways to view, if no window can be opened."""
    if not has_screen():
        raise InputError("no screen here to open the viewer on", expected="--web, or --screenshot OUT.png")


def open_native(files: Sequence[Path]) -> int:
    """Open the desktop viewer and wait until it is closed; its exit status. It listens on this machine only.

    Raises InputError where there is no screen for it.
    """
    require_screen()
    found = [str(file) for file in require_recordings(files)]
    with running(["--port", str(free_port()), *found]) as process:
        return process.wait()


def free_port() -> int:
    """A port of this machine that nobody listens on."""
    with socket.socket() as probe:
        probe.bind((LOOPBACK, 0))
        return probe.getsockname()[1]


@contextmanager
def headless_viewer() -> Iterator[ViewerClient]:
    """A viewer without a window that listens on this machine only; it ends with the block.

    Raises InputError, saying what to install, where it does not come up.
    """
    from rerun.experimental import ViewerClient

    port = free_port()
    # started here and not by ViewerClient.spawn, which lets it listen on every network (0.0.0.0)
    quiet = ["--headless", "--hide-welcome-screen", "--port", str(port)]
    with tempfile.TemporaryFile() as said, running(quiet, said) as process:
        try:
            yield ViewerClient.connect(wait_until_listening(process, port))
        except (RuntimeError, OSError) as error:
            said.seek(0)
            words = "no graphics adapter" if b"adapter" in said.read() else str(error).strip().split("\n")[0]
            problem = f"no picture could be drawn here ({words})"
            raise InputError(problem, field="--screenshot", expected=INSTALL_VULKAN) from None


def wait_until_listening(process: subprocess.Popen[bytes], port: int) -> str:
    """The viewer's address once it answers on port. Raises ConnectionError where it ended or stays silent."""
    deadline = time.monotonic() + VIEWER_PATIENCE
    while time.monotonic() < deadline:
        if process.poll() is not None:
            raise ConnectionError(f"the viewer ended with status {process.returncode}")
        with socket.socket() as probe:
            if probe.connect_ex((LOOPBACK, port)) == 0:
                return f"rerun+http://{LOOPBACK}:{port}/proxy"
        time.sleep(0.1)
    raise ConnectionError(f"the viewer did not answer within {VIEWER_PATIENCE:.0f} s")


def screenshot(files: Sequence[Path], picture: Path, at: float | None = None, settle: float = 6.0) -> Path:
    """A PNG of the viewer showing the files, without a screen; at [s] on the time line, settle [s] for it to load.

    Raises InputError, saying what to install, where no picture can be drawn on this machine.
    """
    from viz.topics.paths import TIMELINE

    found = require_recordings(files)
    with headless_viewer() as viewer:
        for file in found:
            viewer.open(str(file))
        time.sleep(settle)
        if at is not None:
            viewer.set_time(TIMELINE, duration=at, play_state="paused")
            time.sleep(0.4 * settle)
        contents = viewer.take_screenshot()
    with written_file(picture) as partial:
        partial.write_bytes(contents)
    return picture


DECLARATION = "/declaration"  # only a plain recording holds one; a session has a layout instead


def holds(file: Path, entity: str) -> bool:
    """Whether an .rrd has something under an entity's path."""
    from tentacle.io.rrd_chunks import read_chunks

    return any(chunk.entity == entity for chunk in read_chunks(file))
