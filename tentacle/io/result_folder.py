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
NAMED = 3  # files that are told by name
WRITTEN_BY = {
    "verdict.json": "diagnose",
    "next_experiment.toml": "diagnose",
    "laws": "diagnose",
    "identification.json": "identify",
    "gait.toml": "optimise",
    "ladder.csv": "compare",
    "grid.csv": "compare",
    "calibration.toml": "blind-trial",
    "validation.json": "validate",
    "table1.csv": "reproduce",
    "table2.csv": "reproduce",
    "fig9.csv": "reproduce",
}
OF_MANY_VERBS = (
    *("report.html", "session.rrd", "model.toml", "effects", "cells", "trials", "validity.csv", "results.json"),
    *("result.toml", "result.json", "validation.txt", "table2.json", "ratios.json"),
)


def told_before(folder: Path) -> str:
    """What a folder holds before results are written into it, and what becomes of that; empty where it holds nothing.

    Results are told by the verb that alone writes a file of such a name; everything else by its name. InputError where
    the folder is a file, before hours of work are lost.
    """
    _require_no_file(folder)
    if not folder.is_dir():
        return ""
    there = sorted(path.name for path in folder.iterdir() if not path.name.startswith("."))
    verbs = sorted({WRITTEN_BY[name] for name in there if name in WRITTEN_BY})
    others = [name for name in there if name not in WRITTEN_BY and not (verbs and name in OF_MANY_VERBS)]
    held = [f"earlier results of tentacle {' and '.join(verbs)}"] if verbs else []
    if others:
        more = f" and {len(others) - NAMED} more" if len(others) > NAMED else ""
        held.append(f"{'other ' if verbs else ''}files ({', '.join(others[:NAMED])}{more})")
    rest = "files of the same name are replaced, all others stay"
    return f"{folder} holds {' and '.join(held)}: {rest}" if held else ""


@contextmanager
def written(folder: Path) -> Iterator[Path]:
    """A folder to write into; on success its files replace those of the same names in `folder`, on failure nothing
    changes.
    """
    _require_no_file(folder)
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
            _require_places(partial, folder)
            _move_into(partial, folder)
        finally:
            shutil.rmtree(partial, ignore_errors=True)


def _require_no_file(folder: Path) -> None:
    if folder.exists() and not folder.is_dir():
        raise InputError("is a file", file=folder, expected="a folder for the results")


def _require_places(partial: Path, folder: Path) -> None:
    """InputError where a file stands in the place of a folder, or a folder in the place of a file."""
    for new in partial.rglob("*"):
        old = folder / new.relative_to(partial)
        if old.exists() and old.is_dir() != new.is_dir():
            words, expected = ("a file", "a folder") if new.is_dir() else ("a folder", "a file")
            raise InputError(f"is {words}", file=old, expected=f"{expected}, or another folder for the results")


def _move_into(partial: Path, folder: Path) -> None:
    """Each file to its place; a folder that is there already keeps what else it holds."""
    for new in partial.iterdir():
        old = folder / new.name
        if new.is_dir() and old.is_dir():
            _move_into(new, old)
        else:
            new.replace(old)
