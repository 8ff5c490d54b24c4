"""The session that `tentacle view` shows of a recording, with the events of a rig's run."""

from __future__ import annotations

from pathlib import Path

from rig.protocol import EventCode
from rig.run_file import read_run
from rig.run_layout import START
from tentacle.io.reading import read_recording
from viz.topics.events import Event
from viz.track import write_recording_view
from viz.viewer import DECLARATION, holds, require_recordings


def with_layout(file: Path, place: Path) -> Path:
    """The file itself if it is a session; for a recording, a session that shows it, written to place."""

    if not file.is_dir() and not holds(require_recordings([file])[0], DECLARATION):
        return file
    events = run_events(file) if not file.is_dir() and holds(file, START) else []
    return write_recording_view(read_recording(file), place, events)


def run_events(file: Path) -> list[Event]:
    """The events of a rig's run: settled, the board's own events, its end."""

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
