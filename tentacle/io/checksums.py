"""A checksum for every block of every signal in an .rrd, written beside it and compared on every read.

The entity /sums has a row per block of time, with lists of equal length: signal, first (row), count, sha256. A static
row has the checksums of static data, with first = count = 0. A text, a frame or an event has its own checksum beside
it. A file whose declaration states no format is older than checksums.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import rerun as rr

    from tentacle.io.rrd_columns import EntityColumns

CHECKSUM_ENTITY = "/sums"
CHECKSUM_FORMAT = 2  # written beside the declaration; files of this format or later have checksums


@dataclass(frozen=True)
class Sum:
    """The checksum of rows [first, first + count) of a signal; of all of it where count is 0."""

    signal: str
    first: int
    count: int
    sha256: str


def columns_digest(columns: Mapping[str, NDArray[Any] | Sequence[str]]) -> str:
    """SHA-256 over named columns: numbers as 64-bit floats (every NaN alike), texts as UTF-8."""
    total = hashlib.sha256()
    for name in sorted(columns):
        values = np.asarray(columns[name])
        total.update(f"{name} {values.shape}\0".encode())
        if values.dtype.kind in "US":
            total.update("\0".join(values.ravel().tolist()).encode())
        elif values.size:
            numbers = np.array(values, dtype="<f8", order="C")
            numbers[np.isnan(numbers)] = np.nan
            total.update(numbers.tobytes())
    return total.hexdigest()


def frame_digest(host_ns: int, jpeg: bytes) -> str:
    """SHA-256 of a camera frame with the time [ns] of its arrival."""
    return hashlib.sha256(f"{host_ns}\0".encode() + jpeg).hexdigest()


def log_sums(stream: rr.RecordingStream, sums: Sequence[Sum], block: int | None = None) -> None:
    """Writes a row of checksums of the block with that number; without a number, of static data."""
    import rerun as rr

    lists = {
        "signal": [one.signal for one in sums],
        "first": [one.first for one in sums],
        "count": [one.count for one in sums],
        "sha256": [one.sha256 for one in sums],
    }
    if block is None:
        stream.log(CHECKSUM_ENTITY, rr.AnyValues(**lists), static=True)
        return
    # A separate block and not `log`, whose batch would come later than the data.
    columns = [column.partition([len(sums)]) for column in rr.AnyValues.columns(**lists)]
    stream.send_columns(CHECKSUM_ENTITY, [rr.TimeColumn("row", sequence=[block])], columns)


def log_text(stream: rr.RecordingStream, entity: str, text: str, media_type: str) -> None:
    """Writes a static text with its checksum and the format that says that there is one."""
    import rerun as rr

    document = rr.TextDocument(text, media_type=media_type)
    stream.log(entity, document, rr.AnyValues(format=CHECKSUM_FORMAT, sha256=text_digest(text)), static=True)


def sound_text(columns: EntityColumns) -> str | None:
    """A static text; None where it does not agree with its checksum. An older file has none."""
    text = str(columns.static("TextDocument:text")[0])
    if columns.has_static("sha256") != columns.has_static("format"):
        return None
    return text if not columns.has_static("sha256") or columns.static("sha256")[0] == text_digest(text) else None


def text_digest(text: str) -> str:
    """SHA-256 of a text."""
    return hashlib.sha256(text.encode()).hexdigest()


def read_sums(columns: EntityColumns | None) -> list[Sum]:
    """The checksums of a file, in the order in which they were written."""
    if columns is None:
        return []
    names = ("signal", "first", "count", "sha256")
    found = []
    if columns.has_static(*names):
        found.append([columns.static(name) for name in names])
    if columns.has_rows(*names):
        found += [list(row) for row in zip(*(columns.lists(name) for name in names), strict=True)]
    return [Sum(*values) for lists in found for values in zip(*lists, strict=True)]


def first_unsound(sums: Sequence[Sum], signal: str, columns: Mapping[str, NDArray[Any]]) -> Sum | None:
    """The first checksum of a signal that does not agree with its rows; rows that were cut off are not compared."""
    rows = min((len(values) for values in columns.values()), default=0)
    for one in sums:
        if one.signal != signal or one.first + one.count > rows:
            continue
        part = {name: values[one.first : one.first + one.count] for name, values in columns.items()}
        if columns_digest(part) != one.sha256:
            return one
    return None


def covered(sums: Sequence[Sum], signal: str) -> int:
    """The row up to which checksums cover a signal without a gap."""
    end = 0
    for one in sorted((one for one in sums if one.signal == signal), key=lambda one: one.first):
        if one.first > end:
            break
        end = max(end, one.first + one.count)
    return end
