"""Fig. 9: mean thrust of a sine over amplitude and frequency for three arms, the reference and the reduced model."""

from __future__ import annotations

import argparse
from pathlib import Path

from tentacle.cli._output import say

HELP = "Fig. 9: mean thrust over amplitude and frequency, 105, 120 and 140 mm, reference and reduced model side by side"


def configure(parser: argparse.ArgumentParser) -> None:
    """The result's arguments."""
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for report.html and fig9.csv")
    parser.add_argument("--coarse", action="store_true", help="take every second amplitude and frequency")
    parser.add_argument("--workers", type=int, metavar="N", help="number of processes, default: one per core")
    parser.add_argument("--cluster", metavar="ADDRESS", help="run on this Dask scheduler instead, tcp://HOST:PORT")


def run(arguments: argparse.Namespace) -> int:
    """All cells of all arms; table, figure, rank correlation."""
    from tentacle.cli.pages.fig9 import write_fig9_page
    from tentacle.io.result_folder import written
    from tentacle.runner import Runner
    from validation.paper_fig9 import thrust_maps, write_thrust_maps

    runner = Runner(arguments.out / "cells", arguments.workers, arguments.cluster)
    maps = thrust_maps(runner, coarse=arguments.coarse)
    with written(arguments.out) as folder:
        write_thrust_maps(maps, folder / "fig9.csv")
        write_fig9_page(maps, folder / "report.html")
    say(*maps.lines, f"wrote {arguments.out}/report.html, fig9.csv")
    return 0
