"""The arguments of `tentacle library`."""

from __future__ import annotations

import argparse
from pathlib import Path


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument(
        "source",
        nargs="+",
        metavar="[diagnose|joint] DIR|LIST",
        help="a folder of .rrd files, or a text file that lists them",
    )
    parser.add_argument("--home", type=Path, metavar="DIR", help="index and verdicts, default: NAME.library beside it")
    parser.add_argument(
        "--where",
        nargs="+",
        default=[],
        metavar="COLUMN=VALUE",
        help="rows to show; also < <= > >= != and ~ (contains)",
    )
    parser.add_argument("--sort", metavar="COLUMN", default="date", help="default: date")
    parser.add_argument("--reverse", action="store_true", help="reverse the order")
    parser.add_argument(
        "--csv", type=Path, metavar="FILE", help="write the rows, every column, instead of showing them"
    )
    parser.add_argument("--check", action="store_true", help="exit 1 where a shown recording has no current verdict")
    parser.add_argument(
        "--changed",
        action="store_true",
        help="joint: exit 1 where an effect acts, or a parameter of an arm has changed",
    )
    parser.add_argument("--no-page", action="store_true", help="leave library.html as it is")
    parser.add_argument(
        "--baseline", nargs="+", default=[], type=Path, metavar="RECORDING", help="diagnose: as in tentacle diagnose"
    )
    parser.add_argument(
        "--seed", type=int, default=0, metavar="N", help="diagnose: as in tentacle diagnose, default: 0"
    )
    parser.add_argument(
        "--renew",
        action="store_true",
        help="diagnose, joint: also recordings that failed, or whose verdict or evidence is of older code",
    )
    parser.add_argument("--workers", type=int, metavar="N", help="diagnose, joint: processes, default: one a core")
    parser.add_argument(
        "--cluster", metavar="ADDRESS", help="diagnose, joint: a Dask scheduler whose workers can read these folders"
    )
    parser.add_argument("--watch", action="store_true", help="diagnose: follow the folder until Ctrl-C")
