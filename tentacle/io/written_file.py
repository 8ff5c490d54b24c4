"""A file that appears complete or not at all; its content is on the disk before it gets its name."""

from __future__ import annotations

import glob
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from tentacle.errors import InputError


@contextmanager
def written_file(file: Path) -> Iterator[Path]:
    """A path to write to; on success it becomes `file`, on failure nothing is left of it.

    InputError for what is no file name, and where something other than a plain file has the name: it would be replaced.
    """
    if not file.name:
        raise InputError("is no file name", file=repr(str(file)), expected="the name of a file to write")
    if not file.parent.is_dir():
        raise InputError("no such folder", file=file.parent, expected="a folder to write to")
    if file.exists() and not file.is_file():
        raise InputError("is there, and is no plain file", file=file, expected="a name that is free, or a file")
    head = f".{file.name[:100]}."
    for left in file.parent.glob(glob.escape(head) + "*.partial"):
        if not is_running(left.name.removeprefix(head).removesuffix(".partial")):
            left.unlink(missing_ok=True)
    partial = file.with_name(f"{head}{os.getpid()}.partial")
    try:
        yield partial
        sync(partial)
        partial.replace(file)
        sync(file.parent)
    except OSError as error:
        if error.filename == str(partial):  # nobody knows that name
            error.filename = str(file)
        raise
    finally:
        partial.unlink(missing_ok=True)


def write_text(file: Path, text: str) -> None:
    """A text file, whole or not at all."""
    with written_file(file) as partial:
        partial.write_text(text, encoding="utf-8", newline="\n")


def sync(path: Path) -> None:
    """Waits until a file's content, or a folder's names, are on the disk; for some folders this is impossible."""
    opened = os.open(path, os.O_RDONLY)
    try:
        with suppress(OSError) if path.is_dir() else _nothing():
            os.fsync(opened)
    finally:
        os.close(opened)


def is_running(process: str) -> bool:
    """Whether a process of that number may run; where that cannot be asked, it may."""
    if not process.isdigit() or sys.platform == "win32":
        return True
    try:
        os.kill(int(process), 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        return True
    return True


@contextmanager
def _nothing() -> Iterator[None]:
    yield
