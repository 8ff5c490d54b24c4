"""`tentacle view`: open recordings and sessions in the viewer, as a web page on this machine, or as a picture."""

from __future__ import annotations

import argparse
from pathlib import Path

from tentacle.cli._output import say

HELP = "show recordings and sessions in the viewer, in a browser, or as a picture without a screen"


def configure(parser: argparse.ArgumentParser) -> None:
    """Files, and one of three ways to see them."""
    parser.add_argument(
        "files", nargs="+", type=Path, metavar="FILE", help="a session or recording (.rrd), or an import folder"
    )
    way = parser.add_mutually_exclusive_group()
    way.add_argument("--web", action="store_true", help="serve the viewer on 127.0.0.1 until Ctrl-C")
    way.add_argument(
        "--screenshot", type=Path, metavar="OUT.png", help="draw the viewer into a picture; needs no screen"
    )
    parser.add_argument("--at", type=float, metavar="SECONDS", help="time of the screenshot")


def run(arguments: argparse.Namespace) -> int:
    """Open the viewer; 0 if it was closed without an error."""
    import tempfile

    from tentacle.cli.pages.recording_view import with_layout
    from tentacle.errors import InputError
    from viz import viewer
    from viz.page import serve_web

    if arguments.at is not None and arguments.screenshot is None:
        raise InputError("only a screenshot has an instant", field="--at", expected="--screenshot OUT.png with it")
    if arguments.screenshot is not None and arguments.screenshot.suffix != ".png":
        raise InputError("not a picture's name", file=arguments.screenshot, field="--screenshot", expected="OUT.png")
    if arguments.screenshot is None and not arguments.web:  # said before videos are made ready for a session
        viewer.require_recordings([file for file in arguments.files if not file.is_dir()])
        viewer.require_screen()
    with tempfile.TemporaryDirectory(prefix="tentacle-view-") as folder:
        shown = [with_layout(file, Path(folder) / f"{number}.rrd") for number, file in enumerate(arguments.files)]
        if arguments.screenshot is not None:
            say(viewer.screenshot(shown, arguments.screenshot, arguments.at))
            return 0
        if arguments.web:
            return serve_web(shown, told=say)
        return viewer.open_native(shown)
