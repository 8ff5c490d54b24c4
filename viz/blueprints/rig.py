"""rig live: servo and load cell over the board's time as they come, what the camera sees, and what happened below."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import rerun as rr
import rerun.blueprint as rrb
from rerun.blueprint.encodings import TextLogColumn, TimelineColumn

from viz.palette import AUGMENTED, MEASURED, NEUTRAL


@dataclass(frozen=True)
class LivePaths:
    """Where a run that is being recorded keeps what: entity paths, its time line; camera: None without one."""

    command: str
    angle: str
    current: str
    thrust: str
    events: str
    timeline: str
    camera: str | None = None


def live_view(name: str, lines: dict[Any, rr.SeriesLines]) -> rrb.TimeSeriesView:
    """A few lines of the run, each path with its look."""
    return rrb.TimeSeriesView(origin="/", contents=list(lines), name=name, overrides=lines)


def rig_blueprint(paths: LivePaths) -> rrb.Blueprint:
    """The layout of a run while it lasts; it follows the newest sample."""
    angles: dict[Any, rr.SeriesLines] = {
        paths.command: rr.SeriesLines(colors=[NEUTRAL.colour], names=["commanded"]),
        paths.angle: rr.SeriesLines(colors=[MEASURED.colour], names=["measured"]),
    }
    force: dict[Any, rr.SeriesLines] = {paths.thrust: rr.SeriesLines(colors=[MEASURED.colour], names=["load cell"])}
    drawn: dict[Any, rr.SeriesLines] = {paths.current: rr.SeriesLines(colors=[AUGMENTED.colour], names=["servo"])}
    columns = rrb.TextLogColumns(
        timeline_columns=[TimelineColumn(paths.timeline, visible=True)],
        text_log_columns=[TextLogColumn("LogLevel"), TextLogColumn("Body")],
    )
    seen = [] if paths.camera is None else [rrb.Spatial2DView(origin=paths.camera, name="camera")]
    return rrb.Blueprint(
        rrb.Vertical(
            live_view("servo angle [rad]", angles),
            live_view("thrust [N]", force),
            rrb.Horizontal(
                *seen,
                live_view("servo current [A]", drawn),
                rrb.TextLogView(origin=paths.events, name="events", columns=columns),
            ),
        ),
        rrb.TimePanel(state="collapsed", timeline=paths.timeline, play_state="following"),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        auto_views=False,
    )


def send_live_layout(viewer: str, application: str, paths: LivePaths) -> None:
    """Tell the viewer at an address (rerun+http://...) how to show the runs of an application."""
    stream = rr.RecordingStream(application)
    stream.connect_grpc(viewer)
    stream.send_blueprint(rig_blueprint(paths), make_active=True, make_default=True)
    stream.flush()
    stream.disconnect()
