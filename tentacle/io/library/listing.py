"""Rows of a library as asked for: chosen, in order, as a CSV file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pyarrow as pa
from pyarrow import csv

from tentacle.errors import InputError
from tentacle.io.library.query import conditions
from tentacle.io.written_file import written_file


def chosen(table: pa.Table, where: Sequence[str], sort: str, reverse: bool = False) -> pa.Table:
    """The rows for which all conditions hold, in the order of a column. InputError names what is unknown."""
    holds = conditions(where, table.schema)
    if holds is not None:
        table = table.filter(holds)
    if sort not in table.schema.names:
        raise InputError(f"no column {sort!r}", field="--sort", expected=f"one of {', '.join(table.schema.names)}")
    return table.sort_by([(sort, "descending" if reverse else "ascending")])


def write_listing_csv(table: pa.Table, file: Path) -> None:
    """Every column of the rows, whole or not at all; InputError where the file has no folder, or is no .csv."""
    if file.suffix != ".csv":
        raise InputError("is no name of a table", file=file, field="--csv", expected="FILE.csv")
    if not file.parent.is_dir():
        raise InputError("no such folder", file=file.parent, field="--csv")
    with written_file(file) as partial:
        csv.write_csv(table, partial)


def all_done(table: pa.Table) -> bool:
    """Whether every row has a verdict of this recording, these settings and this code."""
    return all(state == "done" for state in table.column("state").to_pylist())
