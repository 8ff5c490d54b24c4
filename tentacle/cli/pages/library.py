"""What `tentacle library` shows: a table in the terminal, and library.html in the library's home."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tentacle.cli._output import cell, say, show

if TYPE_CHECKING:
    import pyarrow as pa

    from tentacle.io.library import Library

SHOWN = ("name", "date", "specimen", "state", "verdict", "effects", "confidence", "before_mm", "after_mm", "floor_mm")
PRINTED_ROWS = 40  # rows in a terminal
FILE_WIDTH = 160  # characters, where the output is no terminal


def print_rows(table: pa.Table) -> None:
    """The first rows, and how many more there are."""
    from rich import box
    from rich.table import Table

    from tentacle.rounding import number

    shown = Table(title=f"{table.num_rows} recording{'s' * (table.num_rows != 1)}", box=box.SIMPLE)
    columns = [*SHOWN, *(["joint"] if table.column("joint").null_count < table.num_rows else [])]
    for name in columns:
        shown.add_column(name, no_wrap=True)
    for row in table.select(columns).slice(0, PRINTED_ROWS).to_pylist():
        shown.add_row(*(cell(number(v) if isinstance(v, float) else _text(v)) for v in row.values()))
    show(shown, width=FILE_WIDTH)
    if table.num_rows > PRINTED_ROWS:
        say(f"and {table.num_rows - PRINTED_ROWS} more: the page and --csv hold all")


def _text(value: Any) -> str:
    return "-" if value is None else f"{value:%Y-%m-%d %H:%M}" if hasattr(value, "strftime") else str(value)


def write_library_page(library: Library) -> Path:
    """library.html with every recording; the residuals of those that leave most."""
    import numpy as np

    from tentacle.io.library.joint import read_joint
    from tentacle.io.library.layers import RESIDUAL
    from viz.library_page import library_page, worst
    from viz.report import write_report

    rows, maps = library.table().to_pylist(), {}
    for row in worst(rows):
        file = library.home / "layers" / row["key"] / RESIDUAL
        left = json.loads(file.read_text(encoding="utf-8")) if file.exists() else []
        if left:
            maps[row["key"]] = np.array(left, dtype=float)
    arms = read_joint(library.joint_file)
    page = library_page(library.source.name, rows, library.parameters().to_pylist(), maps, arms)
    return write_report(page, library.home / "library.html")


def print_joint(library: Library) -> None:
    """The joint answer of every arm, in sentences."""
    from tentacle.io.library.joint import read_joint
    from viz.joint_words import arm_title, joint_sentences

    rows = {row["sha256"]: row for row in library.table().to_pylist()}
    for arm in read_joint(library.joint_file):
        say(arm_title(arm))
        for sentence in joint_sentences(arm, rows):
            say(f"  {sentence}")
