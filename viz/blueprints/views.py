"""The views that the verbs' layouts are made of; every one names its unit."""

from __future__ import annotations

from typing import Literal

import numpy as np
import rerun.blueprint as rrb
from rerun.blueprint.encodings import TextLogColumn, TimelineColumn

from tentacle.recording import Declaration
from viz.topics.paths import TIMELINE


def space_view(path: str, declaration: Declaration, name: str) -> rrb.Spatial3DView:
    """The tank from the camera's side and a little above: n to the right, gravity down, the arm's whole reach in view.

    The default eye of the viewer clips an object of this size.
    """
    length = declaration.specimen.length
    pull = declaration.gravity.angle
    down = np.array([np.sin(pull), np.cos(pull), 0.0])
    across = np.array([down[1], -down[0], 0.0])
    away = np.array([0.0, 0.0, -1.0])  # x right and y down, as in a picture, is seen from below z = 0
    target = np.array([0.0, 0.45 * length, 0.0])
    eye = target + length * (1.6 * away + 0.4 * across - 0.25 * down)
    controls = rrb.EyeControls3D(position=eye, look_target=target, eye_up=-down)
    return rrb.Spatial3DView(origin=f"{path}/arms", name=name, eye_controls=controls, line_grid=False)


def lines_view(path: str, name: str) -> rrb.TimeSeriesView:
    """Lines over time; the name says quantity and unit."""
    return rrb.TimeSeriesView(origin=path, name=name, plot_legend=rrb.PlotLegend(corner=rrb.Corner2D.LeftTop))


def camera_view(path: str) -> rrb.Spatial2DView:
    """The video with what is drawn over it."""
    return rrb.Spatial2DView(origin=f"{path}/camera", name="camera")


def tip_view(path: str, reach: float) -> rrb.Spatial2DView:
    """The tips, enlarged, reach [mm] to each side of the measured one."""
    bounds = rrb.VisualBounds2D(x_range=(-reach, reach), y_range=(-reach, reach))
    return rrb.Spatial2DView(origin=f"{path}/tip", name="tip, enlarged", visual_bounds=bounds)


def events_view(path: str) -> rrb.TextLogView:
    """The event log of a run."""
    columns = rrb.TextLogColumns(  # the text says the time: the viewer's own column is too narrow to read
        timeline_columns=[TimelineColumn(TIMELINE, visible=False)],
        text_log_columns=[TextLogColumn("LogLevel"), TextLogColumn("Body")],
    )
    return rrb.TextLogView(origin=f"{path}/events", name="events", columns=columns)


def blueprint_page(*parts: rrb.BlueprintPart, state: Literal["paused", "following"] = "paused") -> rrb.Blueprint:
    """A layout with a low time panel that stands on the shared time line, other panels closed."""
    return rrb.Blueprint(
        *parts,
        rrb.TimePanel(state="collapsed", timeline=TIMELINE, play_state=state),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        auto_views=False,
    )
