"""`tentacle compare`: the reduced model against the MuJoCo reference, and the map of where it may be trusted."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from tentacle.cli._effects import add_effects
from tentacle.cli._output import cell, say, show

if TYPE_CHECKING:
    from validation.ladder import Ladder
    from validation.validity_map import Validity

HELP = "compare the affine model (orders 2, 3, 4) with the MuJoCo reference: a series of checks and a validity map"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument("models", type=Path, nargs="+", metavar="MODEL.toml", help="one or several arms")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for report, session and tables")
    parser.add_argument(
        "--amplitude", type=float, default=0.4, metavar="RAD", help="amplitude of the driven motion, default: 0.4"
    )
    parser.add_argument(
        "--frequency", type=float, metavar="HZ", help="frequency of the driven motion, default: 0.6 of the first mode"
    )
    parser.add_argument("--no-map", action="store_true", help="make the series of checks only, no validity map")
    parser.add_argument("--tapers", type=float, nargs="*", default=(), metavar="R", help="map arms of these r_tip/r0")
    parser.add_argument(
        "--slenderness", type=float, nargs="*", default=(), metavar="R", help="map arms with these L/r0 too"
    )
    parser.add_argument(
        "--workers", type=int, metavar="N", help="number of processes for the map, default: one per core"
    )
    add_effects(parser)
    parser.add_argument("--cluster", metavar="ADDRESS", help="run on this Dask scheduler instead, tcp://HOST:PORT")


def run(arguments: argparse.Namespace) -> int:
    """Run the series of checks for every model, compute the map, write the results."""
    from rich.console import Console

    from tentacle.cli.pages.compare import write_compare_page, write_compare_session
    from tentacle.cli.pages.compare_grid import write_grid
    from tentacle.io.model_file import read_model
    from tentacle.io.result_folder import written
    from tentacle.runner import Runner
    from validation.ladder import run_ladder
    from validation.ladder_table import write_ladder
    from validation.validity_map import validity_maps, variants, write_cells

    _check(arguments)
    models = {file: read_model(file) for file in arguments.models}
    arms = {file: variants(model, arguments.tapers, arguments.slenderness) for file, model in models.items()}
    console = Console(stderr=True)
    answers = []
    for file, model in models.items():
        out = arguments.out if len(models) == 1 else arguments.out / file.stem
        with console.status(cell(f"{file.stem}: ladder")):
            ladder = run_ladder(model, arguments.amplitude, arguments.frequency)
        maps = []
        if not arguments.no_map:
            # All arms of a grid share one folder of results.
            runner = Runner(arguments.out / "cells", arguments.workers, arguments.cluster)
            maps = validity_maps(arms[file], runner)
        with written(out) as folder:
            if maps:
                write_cells(maps, folder / "validity.csv")
            write_ladder(ladder, folder / "ladder.csv")
            write_compare_page(file, model, ladder, maps, folder / "report.html")
            write_compare_session(file.stem, model, ladder, maps, folder / "session.rrd")
        answers.append((file, ladder, maps))
        _print(file.stem, ladder, maps)
        say(f"wrote {out}/report.html, session.rrd, ladder.csv" + ("" if arguments.no_map else ", validity.csv"))
    if len(models) > 1:
        with written(arguments.out) as folder:
            write_grid(answers, folder)
        say(f"wrote {arguments.out}/report.html, grid.csv")
    return 0


def _check(arguments: argparse.Namespace) -> None:
    from tentacle.errors import InputError

    for name in ("amplitude", "frequency"):
        number = getattr(arguments, name)
        if number is not None and not number > 0.0:
            raise InputError(f"{number!r} is not usable", field=f"--{name}", expected="above 0")
    for taper in arguments.tapers:
        if not 0.0 <= taper <= 1.0:
            raise InputError(f"{taper!r} is not usable", field="--tapers", expected="r_tip/r0 from 0 to 1")
    for slenderness in arguments.slenderness:
        if not slenderness > 2.0:
            raise InputError(
                f"{slenderness!r} is not the ratio of a slender arm", field="--slenderness", expected="L/r0 above 2"
            )
    if len({file.stem for file in arguments.models}) < len(arguments.models):
        raise InputError("two models share a file name", field="MODEL.toml", expected="names that differ")


def _print(name: str, ladder: Ladder, maps: list[Validity]) -> None:
    from rich.table import Table

    from validation.ladder_table import ladder_rows
    from validation.validity_advice import sentence

    for part in ladder_rows(ladder):
        table = Table(title=cell(f"{name}: {part.title}"))
        for i, title in enumerate(part.header):
            table.add_column(title, justify="left" if i < 2 else "right", no_wrap=i >= 2)
        for row in part.rows:
            table.add_row(*row)
        show(table, width=140)
    if ladder.third_opinion is not None:
        say(f"PyElastica: first frequency in air {ladder.third_opinion:.4g} Hz")
    if maps:
        say(sentence(maps[0]))
