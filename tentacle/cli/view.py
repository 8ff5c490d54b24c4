"""`tentacle view`: open recordings in the viewer, as a web page on this machine, or as a picture."""

from __future__ import annotations

import argparse
from pathlib import Path

HELP = "open recordings (.rrd) in the viewer, in a browser, or as a picture without a screen"


def configure(parser: argparse.ArgumentParser) -> None:
    """Files, and one of three ways to see them."""
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE", help="a recording or session (.rrd)")
    way = parser.add_mutually_exclusive_group()
    way.add_argument("--web", action="store_true", help="serve the viewer on 127.0.0.1 until Ctrl-C")
    way.add_argument(
        "--screenshot", type=Path, metavar="OUT.png", help="draw the viewer into a picture; needs no screen"
    )
    parser.add_argument("--at", type=float, metavar="SECONDS", help="the instant that a screenshot shows")


def run(arguments: argparse.Namespace) -> int:
    """Open what was asked for; 0 when the viewer was closed in peace."""
    from tentacle.errors import InputError
    from viz import viewer

    if arguments.screenshot is not None:
        print(viewer.screenshot(arguments.files, arguments.screenshot, arguments.at))
        return 0
    if arguments.at is not None:
        raise InputError("only a screenshot has an instant", field="--at", expected="--screenshot OUT.png with it")
    return viewer.serve_web(arguments.files) if arguments.web else viewer.open_native(arguments.files)
