"""An .rrd file's entities as columns of numpy arrays."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from tentacle.io.rrd_chunks import bytes_lost, read_chunks

ROW = "row"  # the timeline by which rows are put in order, where an entity has it


@dataclass
class EntityColumns:
    """One entity: static values by component, and rows by component, in the order of the `row` timeline.

    Timelines are components of whole numbers named @TIMELINE. Without a `row` the rows are in the file's order.
    """

    statics: dict[str, pa.ListArray] = field(default_factory=dict)
    chunks: dict[str, list[tuple[NDArray[np.int64], pa.Array]]] = field(default_factory=dict)

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
        return bytes_of(self.statics[name])

    def rows(self, name: str) -> NDArray[Any]:
        """A component (rows, values per row)."""
        parts = [_table(values) for _, values in self.chunks[name]]
        order = np.argsort(np.concatenate([rows for rows, _ in self.chunks[name]]), kind="stable")
        return np.concatenate(parts)[order]

    def flat(self, name: str) -> NDArray[np.float64]:
        """A component with one value a row, as (rows,)."""
        return np.ascontiguousarray(self.rows(name)[:, 0], dtype=float)

    def times(self, timeline: str) -> NDArray[np.int64]:
        """A timeline's whole numbers (rows,): nanoseconds, or a count."""
        return self.rows(f"@{timeline}")[:, 0].astype(np.int64)

    def texts(self, name: str) -> list[str]:
        """A component with one text a row."""
        return [str(text) for text in self.rows(name)[:, 0]] if name in self.chunks else []

    def lists(self, name: str) -> list[list[Any]]:
        """A component with any number of values a row."""
        cells = [(row, cell) for rows, values in self.chunks[name] for row, cell in
                 zip(rows.tolist(), values.to_pylist(), strict=True)]  # fmt: skip
        return [cell for _, cell in sorted(cells, key=lambda pair: pair[0])]

    def aligned(self, *names: str) -> list[NDArray[Any]]:
        """Several components, each (rows, values per row), up to the last row that all of them have."""
        tables = [self.rows(name) for name in names]
        count = min(map(len, tables))
        return [table[:count] for table in tables]

    def row_bytes(self, name: str) -> list[bytes]:
        """A blob a row."""
        cells = [(row, values[i : i + 1]) for rows, values in self.chunks[name] for i, row in enumerate(rows)]
        return [bytes_of(cell) for _, cell in sorted(cells, key=lambda cell: cell[0])]


def read_entities(
    file: Path, wanted: Callable[[str], bool] = lambda _entity: True
) -> tuple[dict[str, EntityColumns], int]:
    """Entity path -> its columns, of those wanted; and how many bytes at the end are no whole message (0: whole)."""
    entities: dict[str, EntityColumns] = {}
    for chunk in read_chunks(file):
        if wanted(chunk.entity):
            add(entities.setdefault(chunk.entity, EntityColumns()), chunk.batch, static=chunk.static)
    return entities, bytes_lost(file)


def add(columns: EntityColumns, batch: pa.RecordBatch, *, static: bool) -> None:
    """Adds a chunk's rows to its entity's columns."""
    names = [name for name in batch.schema.names if pa.types.is_list(batch.schema.field(name).type)]
    timelines = [name for name in batch.schema.names if name not in names and not name.startswith("rerun.")]
    if static:
        columns.statics.update({name: batch.column(name) for name in names})
        return
    if not timelines:
        return
    numbers = {name: whole_numbers(batch.column(name)) for name in timelines}
    before = sum(len(rows) for rows, _ in columns.chunks.get(f"@{timelines[0]}", []))
    order = numbers[ROW] if ROW in numbers else before + np.arange(len(batch))
    for name in names:
        values = batch.column(name)
        filled = values.is_valid()
        rows = order[filled.to_numpy(zero_copy_only=False)]
        if len(rows):
            columns.chunks.setdefault(name, []).append((rows, values.filter(filled)))
    for name, found in numbers.items():
        columns.chunks.setdefault(f"@{name}", []).append((order, pa.array(found)))


def whole_numbers(values: pa.Array) -> NDArray[np.int64]:
    """A timeline's column as whole numbers: nanoseconds, or a count."""
    return values.cast(pa.int64()).to_numpy(zero_copy_only=False).astype(np.int64)


def _table(values: pa.Array) -> NDArray[Any]:
    flat = values
    while pa.types.is_list(flat.type):
        flat = flat.flatten()
    table = np.asarray(flat.to_pylist()) if pa.types.is_string(flat.type) else flat.to_numpy(zero_copy_only=False)
    return table.reshape(len(values), -1)


def bytes_of(values: pa.Array) -> bytes:
    """A cell's blob."""
    flat = values.flatten()
    if pa.types.is_list(flat.type):
        flat = flat.flatten()
    if pa.types.is_binary(flat.type) or pa.types.is_large_binary(flat.type):
        return flat[0].as_py()
    return flat.to_numpy(zero_copy_only=False).astype(np.uint8).tobytes()
