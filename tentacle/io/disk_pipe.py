"""A pipe into a file. Rerun writes to the disk through it, so that Rerun never sees errors of the disk.

Rerun does not report a full disk, and a stream whose file failed can hang forever when it is closed. Its end of the
pipe never fails: after an error of the disk, the rest is read and dropped.

A forked child inherits Rerun's end, and a pipe ends only when all its ends are closed. So each child closes its own.
"""

from __future__ import annotations

import array
import os
import select
import threading
import time
from contextlib import suppress
from pathlib import Path

ENTRANCES = Path("/dev/fd")  # where the system has it
AT_ONCE = 1 << 16  # bytes: what a pipe holds
LOOK_AGAIN = 1e-3  # s between two looks at what is still in the pipe


class DiskPipe:
    """Copies the pipe to `file` in a thread of its own. OSError where the file cannot be opened."""

    def __init__(self, file: Path) -> None:
        with _forking:
            self._read_end, self._write_end = os.pipe()  # before the file is opened: an error here leaves it unchanged
            self._pipe = _identity(self._read_end)
            _pipes.add(self._pipe)
        try:
            self._file = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o666)
        except OSError:
            _pipes.discard(self._pipe)
            os.close(self._read_end)
            os.close(self._write_end)
            raise
        self._name = str(file)
        self._error: OSError | None = None
        self._abandoned = False
        self._copying = threading.Lock()  # held from a read to the end of its write
        self._thread = threading.Thread(target=self._copy, name="disk", daemon=True)
        self._thread.start()

    @property
    def entrance(self) -> str:
        """The path under which a writer opens the pipe, before `opened` is called."""
        return str(ENTRANCES / str(self._write_end))

    def opened(self) -> None:
        """Closes this end: the pipe ends when its writer closes it."""
        os.close(self._write_end)

    def settle(self, within: float) -> None:
        """Waits until the file has all that was written into the pipe.

        OSError of the disk; TimeoutError where it takes longer than `within` [s].
        """
        end = time.monotonic() + within
        while self._copying.acquire(timeout=max(end - time.monotonic(), 0.0)):
            try:
                waiting = 0 if self._read_end < 0 else _bytes_in(self._read_end)
            finally:
                self._copying.release()
            if self._error is not None:
                raise self._error
            if waiting == 0:
                return
            time.sleep(LOOK_AGAIN)
        raise TimeoutError(f"{self._name} was not written within {within:g} s")

    def finish(self) -> None:
        """Waits for the pipe's end, after its writer was closed. OSError of the disk."""
        self._thread.join()
        if self._error is not None:
            raise self._error

    def abandon(self) -> None:
        """For a disk that hangs: further data are dropped, so that the writer can end."""
        self._abandoned = True
        if self._read_end < 0:
            return
        threading.Thread(target=self._let_go, args=(os.dup(self._read_end),), daemon=True).start()

    def _copy(self) -> None:
        ready = select.poll()  # select.select takes no descriptor above 1023
        ready.register(self._read_end, select.POLLIN)
        try:
            while True:
                ready.poll()
                with self._copying:
                    content = os.read(self._read_end, AT_ONCE)
                    if not content:
                        return
                    self._write(content)
        finally:
            with self._copying:
                _pipes.discard(self._pipe)
                os.close(self._read_end)
                self._read_end = -1
            self._close()

    def _write(self, content: bytes) -> None:
        if self._error is not None or self._abandoned:
            return
        rest = memoryview(content)
        try:
            while rest:
                rest = rest[os.write(self._file, rest) :]
        except OSError as error:
            self._error = OSError(error.errno, error.strerror, self._name)

    def _close(self) -> None:
        try:
            os.close(self._file)
        except OSError as error:  # some network file systems report a full disk only now
            self._error = self._error or OSError(error.errno, error.strerror, self._name)

    @staticmethod
    def _let_go(read_end: int) -> None:
        while os.read(read_end, AT_ONCE):
            pass
        os.close(read_end)


def _bytes_in(pipe: int) -> int:
    """How many bytes are in a pipe."""
    import fcntl  # there is none on Windows, where this module can be imported all the same
    import termios

    count = array.array("i", [0])
    fcntl.ioctl(pipe, termios.FIONREAD, count)
    return count[0]


_forking = threading.Lock()  # held while a pipe is made, and while the process forks
_pipes: set[tuple[int, int]] = set()  # that are open


def _identity(descriptor: int) -> tuple[int, int]:
    found = os.fstat(descriptor)
    return found.st_dev, found.st_ino


def _close_in_child() -> None:
    """In a forked child both ends of every pipe become the null device; their numbers stay in use, because Rerun may
    close its own.
    """
    _forking.release()
    if not _pipes:
        return
    nowhere = os.open(os.devnull, os.O_RDWR)
    for entrance in list(ENTRANCES.iterdir()):
        descriptor = int(entrance.name)
        with suppress(OSError):  # the listing's own is closed by now
            if _identity(descriptor) in _pipes:
                os.dup2(nowhere, descriptor, inheritable=False)
    os.close(nowhere)
    _pipes.clear()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=_forking.acquire, after_in_parent=_forking.release, after_in_child=_close_in_child)
