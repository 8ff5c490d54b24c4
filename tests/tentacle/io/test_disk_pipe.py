"""The pipe into a file: all bytes arrive; a disk that is full or stands still never holds up who writes."""

from __future__ import annotations

import errno
import os
import resource
import threading
from pathlib import Path

import numpy as np
import pytest

from tentacle.io.disk_pipe import AT_ONCE, DiskPipe

CONTENT = np.random.default_rng(5).bytes(40 * AT_ONCE + 17)  # many times what a pipe holds


def write(pipe: DiskPipe, content: bytes) -> int:
    """Opens the pipe as Rerun does, and writes; the open descriptor."""
    entrance = os.open(pipe.entrance, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    pipe.opened()
    rest = memoryview(content)
    while rest:
        rest = rest[os.write(entrance, rest) :]
    return entrance


def test_the_file_has_all_that_was_written_once_it_has_settled(tmp_path: Path) -> None:
    pipe = DiskPipe(tmp_path / "file")
    entrance = write(pipe, CONTENT)
    pipe.settle(5.0)
    assert (tmp_path / "file").read_bytes() == CONTENT
    os.write(entrance, b"end")
    os.close(entrance)
    pipe.finish()
    assert (tmp_path / "file").read_bytes() == CONTENT + b"end"
    pipe.settle(5.0)  # at its end nothing is on its way


def test_a_full_disk_is_told_and_holds_up_nobody() -> None:
    pipe = DiskPipe(Path("/dev/full"))
    entrance = write(pipe, CONTENT)
    with pytest.raises(OSError, match="/dev/full") as caught:
        pipe.settle(5.0)
    assert caught.value.errno == errno.ENOSPC
    os.close(entrance)
    with pytest.raises(OSError, match="No space left"):
        pipe.finish()


def test_a_program_with_many_files_open_loses_nothing(tmp_path: Path) -> None:
    """Above descriptor 1023 select.select fails."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if hard != resource.RLIM_INFINITY and hard < 1200:
        pytest.skip("this system allows no program that many open files")
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(soft, 1200), hard))
    null = os.open(os.devnull, os.O_RDONLY)
    others = [os.dup(null) for _ in range(1024)]
    try:
        pipe = DiskPipe(tmp_path / "file")
        os.close(write(pipe, CONTENT))
        pipe.finish()
    finally:
        for other in (null, *others):
            os.close(other)
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
    assert (tmp_path / "file").read_bytes() == CONTENT


def test_a_file_that_cannot_be_opened_leaves_no_descriptor(tmp_path: Path) -> None:
    before = len(list(Path("/dev/fd").iterdir()))
    with pytest.raises(FileNotFoundError):
        DiskPipe(tmp_path / "no folder" / "file")
    assert len(list(Path("/dev/fd").iterdir())) == before


def test_a_disk_that_stands_still_is_told_and_can_be_left_behind(tmp_path: Path) -> None:
    """A named pipe that nobody empties takes one pipe's length, and then nothing."""
    os.mkfifo(tmp_path / "disk")
    never_read = os.open(tmp_path / "disk", os.O_RDONLY | os.O_NONBLOCK)
    pipe = DiskPipe(tmp_path / "disk")
    entrance = write(pipe, CONTENT[: 2 * AT_ONCE])
    with pytest.raises(TimeoutError, match="not written within"):
        pipe.settle(0.05)
    pipe.abandon()
    rest = memoryview(CONTENT)
    while rest:
        rest = rest[os.write(entrance, rest) :]
    os.close(entrance)
    os.close(never_read)  # the write that stood still fails now, and the thread ends
    with pytest.raises(BrokenPipeError):
        pipe.finish()


@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")  # Python 3.12 warns: this process has threads
def test_a_forked_child_does_not_hold_the_pipe_open(tmp_path: Path) -> None:
    """The child lives on after the file is closed, as a worker of a pool does."""
    pipe = DiskPipe(tmp_path / "file")
    entrance = write(pipe, CONTENT)
    asleep, wake = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(wake)
        os.read(asleep, 1)
        os._exit(0)
    os.write(entrance, b"end")
    os.close(entrance)
    ended = threading.Thread(target=pipe.finish, daemon=True)
    ended.start()
    ended.join(5.0)
    held = ended.is_alive()
    os.close(wake)
    os.close(asleep)
    os.waitpid(child, 0)
    assert not held
    assert (tmp_path / "file").read_bytes() == CONTENT + b"end"
