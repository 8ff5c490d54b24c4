"""The arguments of `tentacle blind-trial`."""

from __future__ import annotations

import argparse
from pathlib import Path

from tentacle.cli._device import add_device

KINDS = "single,pair,null,unknown"
VIDEO_SHARE = 0.25
PLANTS = "stranger,chain"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument(
        "count", type=int, metavar="N", help="number of trials; a longer series begins with the trials of a shorter one"
    )
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="folder for report.html, results.json, ..."
    )
    parser.add_argument("--seed", type=int, default=0, help="the same seed gives the same trials (default 0)")
    place = parser.add_mutually_exclusive_group()
    place.add_argument("--workers", type=int, metavar="W", help="number of processes (default: one per core)")
    place.add_argument("--cluster", metavar="ADDRESS", help="run on this Dask scheduler instead, tcp://HOST:PORT")
    add_device(parser)
    parser.add_argument(
        "--like",
        type=Path,
        metavar="RECORDING",
        help="make trials with the arm, base motion, length and noise of this recording",
    )
    parser.add_argument(
        "--own-errors",
        action="store_true",
        help="with --like: the noise of the trials is what the declared model leaves in that recording",
    )
    parser.add_argument(
        "--baseline",
        type=Path,
        nargs="+",
        default=[],
        metavar="RECORDING",
        help="with --like: real recordings that each diagnosis is told to be complete",
    )
    parser.add_argument(
        "--video-share",
        type=float,
        metavar="SHARE",
        help=f"share of trials that are rendered as video and tracked (default {VIDEO_SHARE})",
    )
    parser.add_argument(
        "--plant",
        metavar="LIST",
        help=f"simulators that hide the effects, drawn at random for each trial (default {PLANTS})",
    )
    parser.add_argument(
        "--repeats",
        action="store_true",
        help="every arm has one or two laws of its own that nobody declares, and each diagnosis has a baseline of it",
    )
    parser.add_argument("--kinds", default=KINDS, metavar="LIST", help=f"kinds of trials (default {KINDS})")
    parser.add_argument(
        "--only",
        type=int,
        nargs="+",
        metavar="K",
        help="only write the recordings of these trials again, as .rrd files",
    )


def comma_separated(text: str) -> list[str]:
    """The words of a list with commas."""
    return [word.strip() for word in text.split(",") if word.strip()]
