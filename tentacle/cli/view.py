"""`tentacle view`: open recordings and sessions in the viewer, as a web page on this machine, or as a picture."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from viz.topics.events import Event

HELP = "open recordings and sessions in the viewer, in a browser, or as a picture without a screen"


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
    parser.add_argument("--at", type=float, metavar="SECONDS", help="the instant that a screenshot shows")


def run(arguments: argparse.Namespace) -> int:
    """Open what was asked for; 0 when the viewer was closed in peace."""
    import tempfile

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
            print(viewer.screenshot(shown, arguments.screenshot, arguments.at))
            return 0
        if arguments.web:
            return serve_web(shown, told=lambda words: print(words, flush=True))
        return viewer.open_native(shown)


def with_layout(file: Path, place: Path) -> Path:
    """The file itself where it is a session; of a recording, a session that shows it, written to place."""
    from rig.recorder import START
    from tentacle.io.reading import read_recording
    from viz.track import write_recording_view
    from viz.viewer import DECLARATION, holds, require_recordings

    if not file.is_dir() and not holds(require_recordings([file])[0], DECLARATION):
        return file
    events = run_events(file) if not file.is_dir() and holds(file, START) else []
    return write_recording_view(read_recording(file), place, events)


def run_events(file: Path) -> list[Event]:
    """What a rig's run says happened: settled, the board's own events, how it ended."""
    from rig.protocol import EventCode
    from rig.run_file import read_run
    from viz.topics.events import Event

    quiet = (EventCode.FLASH_ON, EventCode.FLASH_OFF)
    faults = (EventCode.UNDERRUN, EventCode.WATCHDOG, EventCode.CLIPPED, EventCode.OVERCURRENT, EventCode.CELL_ERROR)
    run = read_run(file)
    events = [
        Event(e.board_s - run.zero, "WARN" if e.code in faults else "INFO", f"{e.code.name.lower()} {e.value}")
        for e in run.events
        if e.code not in quiet
    ]
    end = max([*run.servo_t[-1:], *run.load_t[-1:]], default=run.zero) - run.zero
    words = "no stop record: the host died"
    if run.stop is not None:
        events.append(Event(0.0, "INFO", f"settled; the load cell rests at {1e3 * float(run.stop['rest_n']):.2f} mN"))
        counters = {name: count for name, count in run.stop.get("counters", {}).items() if count}
        counted = ", ".join(f"{name} {count}" for name, count in counters.items())
        words = "; ".join(part for part in (run.stop.get("words"), counted) if part)
    level = "INFO" if run.outcome == "complete" else "ERROR"
    return [*events, Event(float(end), level, f"{run.outcome}: {words}" if words else run.outcome)]
