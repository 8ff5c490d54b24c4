"""An .rrd file's chunks as columns of numpy arrays, whole or up to where the file is cut off."""

from __future__ import annotations

import struct
import tempfile
import warnings
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
from rerun.chunk import RrdReader

from tentacle.errors import InputError

MAGIC = b"RRF2"
FOOTER_MAGIC = b"RRF2FOOT"  # begins the last 12 bytes of a file that was closed
FOOTER_END = 12
STREAM_HEADER = 12  # bytes: magic, version, encoding options
MESSAGE_HEADER = struct.Struct("<QQ")  # kind, length of what follows


@dataclass
class Columns:
    """One entity: static values by component, and rows by component, in the order of the `row` timeline."""

    statics: dict[str, pa.ListArray] = field(default_factory=dict)
    chunks: dict[str, list[tuple[NDArray[np.int64], pa.ListArray]]] = field(default_factory=dict)

    @property
    def row_count(self) -> int:
        """Rows of the component that has the fewest; 0 where there is none."""
        counts = [sum(len(rows) for rows, _ in chunks) for chunks in self.chunks.values()]
        return min(counts, default=0)

    def has_rows(self, *names: str) -> bool:
        """Whether all these components have rows."""
        return all(name in self.chunks for name in names)

    def has_static(self, *names: str) -> bool:
        """Whether all these components are there as static values."""
        return all(name in self.statics for name in names)

    def static(self, name: str) -> list[Any]:
        """A static component's values."""
        return self.statics[name].flatten().to_pylist()

    def static_bytes(self, name: str) -> bytes:
        """A static blob."""
        return _bytes_of(self.statics[name])

    def rows(self, name: str) -> NDArray[Any]:
        """A component (rows, values per row)."""
        parts = [_table(values) for _, values in self.chunks[name]]
        order = np.argsort(np.concatenate([rows for rows, _ in self.chunks[name]]), kind="stable")
        return np.concatenate(parts)[order]

    def flat(self, name: str) -> NDArray[np.float64]:
        """A component with one value a row, as (rows,)."""
        return np.ascontiguousarray(self.rows(name)[:, 0], dtype=float)

    def aligned(self, *names: str) -> list[NDArray[Any]]:
        """Several components, each (rows, values per row), up to the last row that all of them have."""
        tables = [self.rows(name) for name in names]
        count = min(map(len, tables))
        return [table[:count] for table in tables]

    def row_bytes(self, name: str) -> list[bytes]:
        """A blob a row."""
        cells = [(row, values[i : i + 1]) for rows, values in self.chunks[name] for i, row in enumerate(rows)]
        return [_bytes_of(cell) for _, cell in sorted(cells, key=lambda cell: cell[0])]


def read_entities(file: Path) -> tuple[dict[str, Columns], int]:
    """Entity path -> its columns, and how many bytes at the end are no whole message (0 where the file is whole)."""
    length, whole = file.stat().st_size, _whole_length(file)
    if whole == length:
        return _collect(file), 0
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "recovered.rrd"
        with file.open("rb") as source:
            copy.write_bytes(source.read(whole))
        return _collect(copy), length - whole


def _whole_length(file: Path) -> int:
    """Bytes up to the end of the last whole message: messages follow one another, each led by its length."""
    length = file.stat().st_size
    with file.open("rb") as opened:
        head = opened.read(STREAM_HEADER)
        if head[: len(MAGIC)] != MAGIC[: len(head)] or not head:
            raise InputError("not an .rrd file", file=file, expected="a file that begins with RRF2")
        opened.seek(max(0, length - FOOTER_END))
        if opened.read(len(FOOTER_MAGIC)) == FOOTER_MAGIC:
            return length
        position = STREAM_HEADER
        while position + MESSAGE_HEADER.size <= length:
            opened.seek(position)
            _, size = MESSAGE_HEADER.unpack(opened.read(MESSAGE_HEADER.size))
            if position + MESSAGE_HEADER.size + size > length:
                break
            position += MESSAGE_HEADER.size + size
    return position


def _collect(file: Path) -> dict[str, Columns]:
    entities: dict[str, Columns] = {}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # a file without a footer was cut off: that is told by the caller
            for chunk in RrdReader(str(file)).stream():
                columns = entities.setdefault(str(chunk.entity_path), Columns())
                _add(columns, chunk.to_record_batch(), static=chunk.is_static)
    except (RuntimeError, ValueError) as error:
        if "No recording store" in str(error):
            return {}
        raise InputError(f"unreadable: {error}", file=file, expected="an .rrd file of Rerun 0.41") from None
    return entities


def _add(columns: Columns, batch: pa.RecordBatch, *, static: bool) -> None:
    names = [name for name in batch.schema.names if pa.types.is_list(batch.schema.field(name).type)]
    for name in names:
        values = batch.column(name)
        if static:
            columns.statics[name] = values
        elif "row" in batch.schema.names:
            filled = values.is_valid()
            rows = batch.column("row").filter(filled).to_numpy(zero_copy_only=False)
            if len(rows):
                columns.chunks.setdefault(name, []).append((rows, values.filter(filled)))


def _table(values: pa.ListArray) -> NDArray[Any]:
    flat = values.flatten()
    if pa.types.is_list(flat.type):
        flat = flat.flatten()
    table = np.asarray(flat.to_pylist()) if pa.types.is_string(flat.type) else flat.to_numpy(zero_copy_only=False)
    return table.reshape(len(values), -1)


def _bytes_of(values: pa.ListArray) -> bytes:
    flat = values.flatten()
    if pa.types.is_list(flat.type):
        flat = flat.flatten()
    if pa.types.is_binary(flat.type) or pa.types.is_large_binary(flat.type):
        return flat[0].as_py()
    return flat.to_numpy(zero_copy_only=False).astype(np.uint8).tobytes()
