"""tentacle library: many recordings as one table, diagnosed where they are new or changed, on one page."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pyarrow as pa

    from tentacle.io.library import Library

HELP = "index a folder of recordings, diagnose what is new or changed, show all as one table and one page"
SHOWN = ("name", "date", "specimen", "state", "verdict", "effects", "confidence", "before_mm", "after_mm", "floor_mm")
COMPLETE, INCOMPLETE = 0, 1  # with --check
PRINTED = 40  # rows in a terminal
POLLED = 2.0  # s between two looks at a folder that is watched


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument(
        "source",
        nargs="+",
        metavar="[diagnose] DIR|LIST",
        help="a folder of .rrd files, or a text file that lists them",
    )
    parser.add_argument("--home", type=Path, metavar="DIR", help="index and verdicts, default: NAME.library beside it")
    parser.add_argument(
        "--where", nargs="+", default=[], metavar="COLUMN=VALUE", help="rows to show; also < <= > >= != and ~ (holds)"
    )
    parser.add_argument("--sort", metavar="COLUMN", help="a leading - turns it round, default: date")
    parser.add_argument(
        "--csv", type=Path, metavar="FILE", help="write the rows, every column, instead of showing them"
    )
    parser.add_argument("--check", action="store_true", help="exit 1 where a shown recording has no current verdict")
    parser.add_argument("--no-page", action="store_true", help="leave library.html as it is")
    parser.add_argument("--baseline", nargs="+", default=[], type=Path, metavar="RECORDING", help="diagnose: as there")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="diagnose: as there, default: 0")
    parser.add_argument(
        "--renew", action="store_true", help="diagnose: also what failed, or has a verdict of older code"
    )
    parser.add_argument("--workers", type=int, metavar="N", help="diagnose: processes, default: one a core")
    parser.add_argument("--cluster", metavar="ADDRESS", help="diagnose: a Dask scheduler that sees these folders")
    parser.add_argument("--watch", action="store_true", help="diagnose: follow the folder until Ctrl-C")


def run(arguments: argparse.Namespace) -> int:
    """Refresh the index, diagnose where asked, show."""
    from tentacle.errors import InputError
    from tentacle.io.library import open_library
    from tentacle.io.provenance import input_hashes

    diagnosing = len(arguments.source) == 2 and arguments.source[0] == "diagnose"
    if not diagnosing and len(arguments.source) != 1:
        raise InputError(f"{len(arguments.source)} given", field="DIR|LIST", expected="one, or diagnose and one")
    if arguments.watch and not diagnosing:
        raise InputError("follows a diagnosis only", field="--watch", expected="tentacle library diagnose DIR --watch")
    settings = None
    if diagnosing:
        settings = {"seed": arguments.seed, "baseline": sorted(input_hashes(arguments.baseline).values())}
    library = open_library(Path(arguments.source[-1]), arguments.home, settings)
    _refresh(library)
    failures = _diagnose(library, arguments) if diagnosing else []
    table = _chosen(library.table(), arguments)
    if arguments.csv is not None:
        _write_csv(table, arguments.csv)
    else:
        _print(table)
    if not arguments.no_page:
        print(f"page: {write_page(library)}")
    for line in failures:
        print(f"tentacle: {line}", file=sys.stderr)
    if arguments.check and any(state != "done" for state in table.column("state").to_pylist()):
        return INCOMPLETE
    return COMPLETE


def _refresh(library: Library) -> None:
    from rich.console import Console

    from tentacle.runner import progress_bar

    console = Console(stderr=True)
    with progress_bar(console, quiet=not console.is_terminal) as progress:
        line = progress.add_task("reading", total=None)
        library.refresh(lambda done, of: progress.update(line, completed=done, total=of))


def _diagnose(library: Library, arguments: argparse.Namespace) -> list[str]:
    """Diagnose what is missing; with --watch again and again as the folder grows, until Ctrl-C."""
    import time

    from tentacle.cli._library_work import diagnose_missing
    from tentacle.runner import Runner

    runner = Runner(library.home / "runs", arguments.workers, arguments.cluster)
    once = {"baseline": arguments.baseline, "seed": arguments.seed}
    failures = diagnose_missing(library, runner, renew=arguments.renew, **once)
    while arguments.watch:
        write_page(library)
        try:
            time.sleep(POLLED)
            if library.refresh() == 0:
                continue
            failures += diagnose_missing(library, runner, renew=False, **once)
        except KeyboardInterrupt:
            return failures
        counted = len([row for row in library.table().column("state").to_pylist() if row == "done"])
        print(f"{counted} recordings have a verdict", flush=True)
    return failures


def _chosen(table: pa.Table, arguments: argparse.Namespace) -> pa.Table:
    from tentacle.errors import InputError
    from tentacle.io.library import conditions

    chosen = conditions(arguments.where, table.schema)
    if chosen is not None:
        table = table.filter(chosen)
    if arguments.sort is None:
        return table
    column, order = arguments.sort.removeprefix("-"), "descending" if arguments.sort.startswith("-") else "ascending"
    if column not in table.schema.names:
        raise InputError(f"no column {column!r}", field="--sort", expected=f"one of {', '.join(table.schema.names)}")
    return table.sort_by([(column, order)])


def _write_csv(table: pa.Table, file: Path) -> None:
    from pyarrow import csv

    csv.write_csv(table, file)
    print(f"wrote {file}: {table.num_rows} recordings")


def _print(table: pa.Table) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table

    from viz.words import number

    shown = Table(title=f"{table.num_rows} recordings", box=box.SIMPLE)
    for name in SHOWN:
        shown.add_column(name, no_wrap=True)
    for row in table.select(SHOWN).slice(0, PRINTED).to_pylist():
        shown.add_row(*(number(v) if isinstance(v, float) else _text(v) for v in row.values()))
    console = Console()
    if not console.is_terminal:
        console = Console(width=160)  # a file has no edge
    console.print(shown)
    if table.num_rows > PRINTED:
        print(f"and {table.num_rows - PRINTED} more: the page and --csv hold all")


def _text(value: Any) -> str:
    return "-" if value is None else f"{value:%Y-%m-%d %H:%M}" if hasattr(value, "strftime") else str(value)


def write_page(library: Library) -> Path:
    """library.html in the library's home."""
    import json

    import numpy as np

    from tentacle.io.library.layers import RESIDUAL
    from viz.library_page import library_page, worst
    from viz.report import write_report

    rows, maps = library.table().to_pylist(), {}
    for row in worst(rows):
        file = library.home / "layers" / row["key"] / RESIDUAL
        left = json.loads(file.read_text(encoding="utf-8")) if file.exists() else []
        if left:
            maps[row["key"]] = np.array(left, dtype=float)
    page = library_page(library.source.name, rows, library.parameters().to_pylist(), maps)
    return write_report(page, library.home / "library.html")
