"""The index: one row a recording file, read from the file's declaration alone, and read again only where it changed.

A file counts as unchanged where its size and time of change are as they were; then its SHA-256 is not computed again.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from tentacle.errors import InputError
from tentacle.io.declaration_file import parse_recording_file, specimen_table
from tentacle.io.rrd_columns import read_entities
from tentacle.io.toml_table import parse_toml

DATE_NOTE = "date"  # a recording's note that says when it was made, ISO 8601; else the file's own time counts
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
    """The index as it was written; empty where there is none, or one of another make."""
    if not file.exists():
        return SCHEMA.empty_table()
    try:
        found = pq.read_table(file)
    except (pa.ArrowInvalid, OSError):
        return SCHEMA.empty_table()
    return found if found.schema.equals(SCHEMA) else SCHEMA.empty_table()


def write_parquet(table: pa.Table, file: Path) -> None:
    """Write a table; the file appears whole or not at all."""
    partial = file.with_name(f".{file.name}.partial")
    pq.write_table(table, partial)
    partial.replace(file)


def refreshed(old: pa.Table, files: Sequence[Path], told: Callable[[int, int], None]) -> tuple[pa.Table, int]:
    """The index of these files, and how many were read anew; told(done, of) as it goes."""
    known = {row["path"]: row for row in old.to_pylist()}
    rows, read = [], 0
    for place, file in enumerate(files):
        status = file.stat()
        row = known.get(str(file))
        if row is None or (row["bytes"], row["mtime_ns"]) != (status.st_size, status.st_mtime_ns):
            row = _row(file, status.st_size, status.st_mtime_ns)
            read += 1
        rows.append(row)
        told(place + 1, len(files))
    return pa.Table.from_pylist(rows, schema=SCHEMA), read


def recordings_of(source: Path) -> list[Path]:
    """The .rrd files of a folder (its subfolders too), or of a list: a text file with a path a line, # comments.

    InputError where it is neither, or a listed file is missing.
    """
    if source.is_dir():
        return sorted(p.resolve() for p in source.rglob("*.rrd") if not _is_result(p.relative_to(source)))
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


def _listed(source: Path) -> Iterable[Path]:
    for row, line in enumerate(source.read_text(encoding="utf-8").splitlines(), start=1):
        text = line.partition("#")[0].strip()
        if not text:
            continue
        path = (source.parent / text).resolve()
        if not path.is_file():
            raise InputError(f"{text}: no such file", file=source, row=row, expected="the path of an .rrd file")
        yield path


def _row(file: Path, size: int, mtime_ns: int) -> dict[str, Any]:
    """What one file says of itself; a file that is no recording has its fault there instead."""
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
