"""Rows of a library as asked for: chosen, in order, as a CSV file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pyarrow as pa
from pyarrow import csv

from tentacle.errors import InputError
from tentacle.io.library.query import conditions


def chosen(table: pa.Table, where: Sequence[str], sort: str, reverse: bool = False) -> pa.Table:
    """The rows for which all conditions hold, in the order of a column. InputError names what is unknown."""
    holds = conditions(where, table.schema)
    if holds is not None:
        table = table.filter(holds)
    if sort not in table.schema.names:
        raise InputError(f"no column {sort!r}", field="--sort", expected=f"one of {', '.join(table.schema.names)}")
    return table.sort_by([(sort, "descending" if reverse else "ascending")])


def write_listing_csv(table: pa.Table, file: Path) -> None:
    """Every column of the rows; InputError where the file's folder is missing."""
    if not file.parent.is_dir():
        raise InputError("no such folder", file=file.parent, field="--csv")
    csv.write_csv(table, file)


def all_done(table: pa.Table) -> bool:
    """Whether every row has a verdict of this recording, these settings and this code."""
    return all(state == "done" for state in table.column("state").to_pylist())
