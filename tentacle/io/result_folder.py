"""A folder of results, whole or not at all: written beside its place, then moved there."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tentacle.errors import InputError


def replaced(folder: Path) -> str:
    """What to say before results are written where results of an earlier run lie; empty where none do."""
    held = folder.is_dir() and any(folder.iterdir())
    return f"{folder} holds earlier results: files of the same name are replaced" if held else ""


@contextmanager
def written(folder: Path) -> Iterator[Path]:
    """A folder to write into; on success its files replace those of the same names in `folder`, on failure nothing
    changes.
    """
    if folder.exists() and not folder.is_dir():
        raise InputError("is a file", file=folder, expected="a folder for the results")
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        partial = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", dir=folder.parent))
    except OSError as error:
        raise InputError(error.strerror or str(error), file=folder, expected="a folder that can be written") from None
    try:
        yield partial
        folder.mkdir(exist_ok=True)
        for file in partial.iterdir():
            file.replace(folder / file.name)
    finally:
        shutil.rmtree(partial, ignore_errors=True)
