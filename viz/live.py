"""`tentacle rig` as it runs: servo, load cell and events into a file, and to a viewer where one listens."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import rerun as rr
import rerun.blueprint as rrb

from tentacle.signals import LoadCellSignal, MotorSignal
from viz.blueprints.views import events_view, lines_view, page
from viz.palette import MEASURED, NEUTRAL, Role
from viz.session import APPLICATION, set_layout
from viz.topics.events import Event, log_events
from viz.topics.lines import log_samples, style_line
from viz.topics.paths import run_path

COMMAND = Role("commanded", NEUTRAL.colour, "--")


def live_blueprint(path: str) -> rrb.Blueprint:
    """Servo and load cell over a sliding window, events below."""
    signals = rrb.Vertical(lines_view(f"{path}/servo", "servo angle [rad]"), lines_view(f"{path}/thrust", "thrust [N]"))
    return page(rrb.Vertical(signals, events_view(path), row_shares=[3, 1]), state="following")


class LiveSession:
    """A running session: samples go in as they come, in batches; what was written before a crash is in the file."""

    def __init__(self, name: str, path: Path, viewer: str | None = None) -> None:
        """path is the .rrd to write; viewer the address of a listening viewer, rerun+http://127.0.0.1:PORT/proxy."""
        self._session = rr.RecordingStream(APPLICATION)
        sinks = [rr.FileSink(path)] if viewer is None else [rr.FileSink(path), rr.GrpcSink(viewer)]
        self._path = run_path(name)
        self._session.set_sinks(*sinks, default_blueprint=live_blueprint(self._path))
        set_layout(self._session, live_blueprint(self._path))
        for place, role in (("servo/command", COMMAND), ("servo/angle", MEASURED), ("thrust/measured", MEASURED)):
            style_line(self._session, f"{self._path}/{place}", role)

    def servo(self, samples: MotorSignal) -> None:
        """A batch of servo samples."""
        log_samples(self._session, f"{self._path}/servo/command", samples.t, samples.command)
        log_samples(self._session, f"{self._path}/servo/angle", samples.t, samples.angle)

    def load_cell(self, samples: LoadCellSignal) -> None:
        """A batch of load cell samples."""
        log_samples(self._session, f"{self._path}/thrust/measured", samples.t, samples.thrust)

    def events(self, events: Iterable[Event]) -> None:
        """What happened: settling, a retry, a fault."""
        log_events(self._session, self._path, events)

    def close(self) -> None:
        """Write what is under way, and end the file."""
        self._session.flush()
        self._session.disconnect()

    def __enter__(self) -> LiveSession:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
