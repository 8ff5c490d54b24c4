"""A folder of results, complete or absent: written beside its place, then moved there, by one process at a time."""

from __future__ import annotations

import glob
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tentacle.errors import InputError
from tentacle.io.folder_lock import owned

MARK = "partial"


def replaced(folder: Path) -> str:
    """A warning before the results of an earlier run are replaced; empty if there are none."""
    held = folder.is_dir() and any(folder.iterdir())
    return f"{folder} holds earlier results: files of the same name are replaced" if held else ""


@contextmanager
def written(folder: Path) -> Iterator[Path]:
    """A folder to write into; on success its files replace those of the same names in `folder`, on failure nothing
    changes.
    """
    if folder.exists() and not folder.is_dir():
        raise InputError("is a file", file=folder, expected="a folder for the results")
    folder = Path(os.path.realpath(folder))  # a link may lead to another disk, and `..` is no name
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(error.strerror or str(error), file=folder, expected="a folder that can be written") from None
    with owned(folder.with_name(f".{folder.name}.lock"), folder, "one command a folder of results"):
        for left in folder.parent.glob(f".{glob.escape(folder.name)}.{MARK}-*"):  # of one that was killed
            shutil.rmtree(left, ignore_errors=True)
        partial = Path(tempfile.mkdtemp(prefix=f".{folder.name}.{MARK}-", dir=folder.parent))
        try:
            yield partial
            folder.mkdir(exist_ok=True)
            for file in partial.iterdir():
                file.replace(folder / file.name)
        finally:
            shutil.rmtree(partial, ignore_errors=True)
