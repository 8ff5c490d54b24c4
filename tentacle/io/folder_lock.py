"""One process per folder: a second one is refused in one line. The lock ends with its process in every case."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from tentacle.errors import InputError


@contextmanager
def owned_folder(folder: Path, expected: str) -> Iterator[None]:
    """Makes the folder if it is missing, and locks it. InputError as `owned`."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(error.strerror or str(error), file=folder, expected="a folder that can be written") from None
    with owned(folder / ".lock", folder, expected):
        yield


@contextmanager
def owned(lock: Path, folder: Path, expected: str) -> Iterator[None]:
    """Holds the lock file, which exists during work in the folder.

    InputError if another process holds it, or if it cannot be made.
    """
    try:
        file = lock.open("a")
    except OSError as error:
        raise InputError(error.strerror or str(error), file=folder, expected="a folder that can be written") from None
    with held(file, InputError("is in use by another process", file=folder, expected=expected)):
        yield


@contextmanager
def held(file: IO[str], refusal: InputError) -> Iterator[None]:
    """Locks the open file, and removes it afterwards. Raises `refusal` if another process holds it."""
    with file:
        try:
            lock_file(file)
        except OSError:
            raise refusal from None
        try:
            yield
        finally:
            if os.name == "posix":  # elsewhere a file that is open cannot be removed
                with suppress(OSError):
                    Path(file.name).unlink()


def lock_file(file: IO[str]) -> None:
    """Take the file for this process alone; OSError where another process has it."""
    if sys.platform == "win32":
        import msvcrt

        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
    else:
        import fcntl

        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if not Path(file.name).exists():  # it was removed by its owner between our opening and locking it
            raise OSError
