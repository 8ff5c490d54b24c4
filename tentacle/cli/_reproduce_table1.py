"""Table I: fifteen arms identified from rendered video, and how far the identified model is from what the camera
saw."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from tentacle.cli._output import say, show

HELP = (
    "Table I: 5 lengths x 3 silicones, simulated, filmed, tracked, identified; errors in the paper's measure and in mm"
)
WHOLE_S = 39.0  # as long as the paper's


def configure(parser: argparse.ArgumentParser) -> None:
    """The result's arguments."""
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for report.html and table1.csv")
    parser.add_argument(
        "--seconds", type=float, default=WHOLE_S, metavar="S", help="duration of the sine, default: the paper's 39 s"
    )
    parser.add_argument("--look", default="clean", help="look of the rendered tank: clean, tank, ..., default: clean")
    parser.add_argument("--seed", type=int, default=0, help="seed of the pictures' noise, default: 0")
    parser.add_argument("--workers", type=int, metavar="N", help="number of processes, default: one per core")
    parser.add_argument("--cluster", metavar="ADDRESS", help="run on this Dask scheduler instead, tcp://HOST:PORT")


def run(arguments: argparse.Namespace) -> int:
    """All arms; the table beside the paper's."""
    from tentacle.cli.pages.table1 import write_table1_page
    from tentacle.errors import InputError
    from tentacle.io.csv_table import write_csv
    from tentacle.io.result_folder import written
    from tentacle.runner import Runner
    from validation.paper_table1 import table1
    from vision.looks import look_named

    if not arguments.seconds >= 3.0:
        raise InputError(f"{arguments.seconds!r} is too short", field="--seconds", expected="3 or more")
    look_named(arguments.look)
    runner = Runner(arguments.out / "cells", arguments.workers, arguments.cluster)
    found = table1(runner, arguments.seconds, arguments.look, arguments.seed)
    with written(arguments.out) as folder:
        write_csv(folder / "table1.csv", dict(found.columns))
        write_table1_page(found, arguments.seed, folder / "report.html")
    _print(arguments.seconds, found.rows)
    say(*found.words, f"wrote {arguments.out}/report.html, table1.csv")
    return 0


def _print(seconds: float, rows: Sequence[tuple[str, ...]]) -> None:
    from rich.table import Table

    from validation.paper_table1 import TABLE1_HEADER

    table = Table(title=f"Table I, judged on {seconds:g} s of sine")
    for i, title in enumerate(TABLE1_HEADER):
        table.add_column(title, justify="left" if i == 0 else "right")
    for row in rows:
        table.add_row(*row)
    show(table, width=140)
