"""The index: one row a recording file, read from the file's declaration alone, and read again only where it changed.

A file counts as unchanged where its size and time of change are as they were; then its SHA-256 is not computed again.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from datetime import UTC, datetime
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from tentacle.errors import InputError
from tentacle.held_signals import signals_held
from tentacle.io.declaration_file import parse_recording_file, specimen_table
from tentacle.io.plain_file import read_plain, require_plain
from tentacle.io.rrd_chunks import just_written
from tentacle.io.rrd_columns import read_entities
from tentacle.io.toml_table import parse_toml
from tentacle.io.written_file import written_file

DATE_NOTE = "date"  # a recording's note that says when it was made, ISO 8601; else the file's own time counts
LONGEST_PATH = 4096  # characters, Linux's limit
FEW, BATCH = 8, 50  # files that are read by a child each; that are asked of a shared child at once
SCHEMA = pa.schema(
    [
        ("path", pa.string()), ("name", pa.string()), ("bytes", pa.int64()), ("mtime_ns", pa.int64()),
        ("sha256", pa.string()), ("specimen", pa.string()), ("length_mm", pa.float64()),
        ("base_radius_mm", pa.float64()), ("tip_mass_g", pa.float64()), ("fluid_kg_m3", pa.float64()),
        ("date", pa.timestamp("us", tz="UTC")), ("seconds", pa.float64()), ("frames", pa.int64()),
        ("seen_as", pa.string()), ("notes", pa.string()), ("fault", pa.string()),
    ]
)  # fmt: skip


def read_index(file: Path) -> pa.Table:
    """The index as it was written; empty where there is none, or one that is torn or of another make."""
    return read_parquet(file, SCHEMA)


def write_parquet(table: pa.Table, file: Path) -> None:
    """Write a table; the file appears whole or not at all."""
    with written_file(file) as partial:
        pq.write_table(table, partial)


def read_parquet(file: Path, schema: pa.Schema) -> pa.Table:
    """A table as it was written; empty where there is none, or one that is torn or of another make."""
    if not file.exists():
        return schema.empty_table()
    try:
        found = pq.read_table(file)
    except (pa.ArrowException, OSError):
        return schema.empty_table()
    return found if found.schema.equals(schema) else schema.empty_table()


def refreshed(old: pa.Table, files: Sequence[Path], told: Callable[[int, int], None]) -> tuple[pa.Table, int]:
    """The index of these files, and how many were read anew; told(done, of) as those are read."""
    known: dict[str, dict[str, Any]] = {row["path"]: row for row in old.to_pylist()}
    changed = [file for file in files if not _unchanged(known.get(str(file)), file)]
    for done, row in enumerate(_rows(changed), start=1):
        known[row["path"]] = row
        told(done, len(changed))
    return pa.Table.from_pylist([known[str(file)] for file in files], schema=SCHEMA), len(changed)


def _unchanged(row: dict[str, Any] | None, file: Path) -> bool:
    status = file.stat()
    return row is not None and (row["bytes"], row["mtime_ns"]) == (status.st_size, status.st_mtime_ns)


def _rows(files: Sequence[Path]) -> Iterator[dict[str, Any]]:
    """The files' rows, one after the other.

    A damaged file can end the process that reads it, so a few are read by a child each, as elsewhere. Many share one
    child; where a file ends that one, it and those beside it are read by a child each.
    """
    if len(files) <= FEW:
        yield from map(_row, files)
        return
    batches = [files[k : k + BATCH] for k in range(0, len(files), BATCH)]
    while batches:
        with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
            while batches:
                batch = batches.pop(0)
                try:
                    with signals_held():  # its child starts here
                        asked = pool.submit(_rows_here, batch)
                    rows = asked.result()
                except BrokenProcessPool:
                    yield from map(_row, batch)
                    break
                yield from rows


def _rows_here(files: Sequence[Path]) -> list[dict[str, Any]]:
    """In the child, which a file may end: read directly."""
    for file in files:
        just_written(file)
    return [_row(file) for file in files]


def recordings_of(source: Path) -> list[Path]:
    """The .rrd files of a folder (its subfolders too), or of a list: a text file with a path a line, # comments.

    InputError where it is neither, or a file in it is missing, a link to nothing, or no regular file.
    """
    if source.is_dir():
        files = sorted(file for file in source.rglob("*.rrd") if not _is_result(file.relative_to(source)))
        for file in files:
            require_plain(file, "an .rrd file")
        return sorted(file.resolve() for file in files)
    if not source.is_file():
        raise InputError("no such folder or list", file=source, expected="a folder of .rrd files, or a list of them")
    if source.suffix == ".rrd":
        raise InputError(
            "is one recording", file=source, expected="a folder of .rrd files, or a text file that lists them"
        )
    return list(_listed(source))


def _is_result(path: Path) -> bool:
    """Whether a path lies in a folder of results, or is hidden."""
    return any(part.startswith(".") or part.endswith(".library") for part in path.parts)


def _lines(source: Path) -> list[str]:
    try:
        return read_plain(source, "a text with the path of an .rrd file a line").decode("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise InputError("is no UTF-8 text", file=source, expected="the path of an .rrd file a line") from None


def _listed(source: Path) -> Iterable[Path]:
    for row, line in enumerate(_lines(source), start=1):
        text = line.partition("#")[0].strip()
        if not text:
            continue
        path = Path(os.path.realpath(source.parent / text)) if len(text) <= LONGEST_PATH and "\0" not in text else None
        if path is None or not path.is_file():
            text = text[:100]
            raise InputError(f"{text}: no such file", file=source, row=row, expected="the path of an .rrd file")
        yield path


def _row(file: Path) -> dict[str, Any]:
    """What one file says of itself; a file that is no recording has its fault there instead."""
    status = file.stat()
    size, mtime_ns = status.st_size, status.st_mtime_ns
    blank: dict[str, Any] = dict.fromkeys(SCHEMA.names)
    with file.open("rb") as stream:
        digest = hashlib.file_digest(stream, "sha256").hexdigest()
    row = {**blank, "path": str(file), "name": file.stem, "bytes": size, "mtime_ns": mtime_ns, "sha256": digest}
    row["date"] = datetime.fromtimestamp(mtime_ns * 1e-9, UTC)
    try:
        return {**row, **_declared(file)}
    except InputError as error:
        return {**row, "fault": error.line()}


def _declared(file: Path) -> dict[str, Any]:
    """Specimen, fluid, date, and how long and as what the arm was seen."""
    entities, _ = read_entities(file)
    if "/declaration" not in entities:
        raise InputError("holds no recording", file=file, expected="an .rrd of `tentacle import`")
    text = str(entities["/declaration"].static("TextDocument:text")[0])
    declared = parse_recording_file(parse_toml(text, file), file=file, text=text)
    specimen, notes = declared.declaration.specimen, declared.notes
    seen = next((name for name in ("midline", "markers", "shape") if f"/{name}" in entities), "video")
    t = entities[f"/{seen}"].flat("t_s") if f"/{seen}" in entities else []
    found: dict[str, Any] = {
        "name": declared.name or file.stem,
        "specimen": hashlib.sha256(repr(sorted(specimen_table(specimen).items())).encode()).hexdigest()[:12],
        "length_mm": 1e3 * specimen.length,
        "base_radius_mm": 1e3 * float(specimen.section.half_thickness(0.0)),
        "tip_mass_g": 1e3 * specimen.tip_mass,
        "fluid_kg_m3": declared.declaration.fluid.density,
        "seconds": float(t[-1] - t[0]) if len(t) else 0.0,
        "frames": len(t),
        "seen_as": seen,
        "notes": "; ".join(f"{name}: {words}" for name, words in notes.items()),
    }
    if DATE_NOTE in notes:
        found["date"] = _date(notes[DATE_NOTE], file)
    return found


def _date(text: str, file: Path) -> datetime:
    try:
        date = datetime.fromisoformat(text)
    except ValueError:
        raise InputError(f"{text!r} is no date", file=file, field=f"notes.{DATE_NOTE}", expected="ISO 8601") from None
    return date if date.tzinfo else date.replace(tzinfo=UTC)
