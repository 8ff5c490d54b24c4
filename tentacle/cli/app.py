"""`tentacle app`: a page in the browser, from a film to a verdict, on this machine alone."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from tentacle.cli._output import say

if TYPE_CHECKING:
    from viz.app.desk import Proposed

HELP = "a page in the browser: choose a film, click where the arm is, run the commands, read the answer"


def configure(parser: argparse.ArgumentParser) -> None:
    """Where recordings and answers are kept, and how the page is reached."""
    parser.add_argument(
        "folder", type=Path, nargs="?", default=Path("my_recordings"), metavar="FOLDER",
        help="where recordings and answers are kept (default: my_recordings)",
    )  # fmt: skip
    parser.add_argument("--port", type=int, default=8137, help="port on 127.0.0.1, 0 for any free one (default 8137)")
    parser.add_argument("--no-browser", action="store_true", help="print the address, and open nothing")


def run(arguments: argparse.Namespace) -> int:
    """Serve until Ctrl-C."""
    import secrets
    import socket
    import webbrowser

    from tentacle.errors import InputError
    from viz.app.desk import Desk
    from viz.app.page import serve

    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # one that was just left is free
        try:
            probe.bind(("127.0.0.1", arguments.port))
        except (OSError, OverflowError) as error:
            words = f"{arguments.port}: {getattr(error, 'strerror', None) or 'no port'}"
            raise InputError(words, field="--port", expected="a free port, 1024 to 65535, or 0 for any") from None
        port = probe.getsockname()[1]
    arguments.folder.mkdir(parents=True, exist_ok=True)
    token = secrets.token_urlsafe(24)
    address = f"http://127.0.0.1:{port}/?token={token}"
    say(f"{address}  (Ctrl-C ends it)")
    if not arguments.no_browser:
        webbrowser.open(address)
    serve(Desk(arguments.folder.resolve(), proposed), port, token)
    return 0


def proposed(film: Path) -> Proposed:
    """Base, tip and the arm's edge beside its base, as vision proposes them."""
    from vision.propose import propose_arm
    from viz.app.desk import Proposed

    found = propose_arm(film)
    return Proposed(found.base_px, found.straight_tip_px(), found.width_px[0], (*found.words, *found.doubts))
