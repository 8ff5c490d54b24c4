"""The session of `tentacle optimise`: swimmers side by side in 3D, their motions and ways, and the search."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from tentacle.signals import Array
from tentacle.specimen import Specimen
from viz.blueprints.views import blueprint_page, lines_view
from viz.palette import AUGMENTED, BASE, MEASURED, NEUTRAL, Role
from viz.session import session_file, session_id, set_layout
from viz.topics.arms import MidlineCourse, log_tube
from viz.topics.lines import log_line

SWIMMER_ROLES = (AUGMENTED, BASE, MEASURED)
TRIAL = "trial"  # the search's own time line
LANE_LENGTHS = 1.1  # arm's lengths between two swimmers


@dataclass(frozen=True)
class Swimmer:
    """An arm under a base motion: theta (T,) [rad], travel (T,) [m] forward, travelling midline xy (T, P, 2) [m]."""

    name: str
    theta: Array
    travel: Array
    xy: Array


@dataclass(frozen=True)
class SearchCourse:
    """The best value (G,) over evaluations (G,)."""

    evaluations: Array
    best: Array


def write_swimming(
    swimmers: Sequence[Swimmer], t: Array, s: Array, arm: Specimen, search: SearchCourse, path: Path | str
) -> Path:
    """Up to three swimmers at t (T,) [s], s (P,), and the search's course."""
    path = Path(path)
    with session_file(path, session_id("swimming", *(swimmer.name for swimmer in swimmers))) as session:
        width = LANE_LENGTHS * arm.length
        for lane, (swimmer, role) in enumerate(zip(swimmers, SWIMMER_ROLES, strict=False)):
            key, party = rr.escape_entity_path_part(swimmer.name), Role(swimmer.name, role.colour, role.dash)
            beside = swimmer.xy + np.array([(lane - 0.5 * (len(swimmers) - 1)) * width, 0.0])
            log_tube(session, f"swim/arms/{key}", party, MidlineCourse(t, s, beside), arm, full=True)
            log_line(session, f"swim/theta/{key}", party, t, swimmer.theta)
            log_line(session, f"swim/travel/{key}", party, t, 100.0 * swimmer.travel)
        furthest = max(float(np.max(swimmer.travel)) for swimmer in swimmers)
        _log_lanes(session, len(swimmers), width, arm.length, furthest)
        session.log("search/best", rr.SeriesLines(colors=[AUGMENTED.colour], names=["best so far"]), static=True)
        trials = rr.TimeColumn(TRIAL, sequence=np.asarray(search.evaluations, dtype=np.int64))
        session.send_columns("search/best", [trials], rr.Scalars.columns(scalars=search.best))
        set_layout(session, _layout(arm.length, furthest, width * len(swimmers)))
    return path


def _log_lanes(session: rr.RecordingStream, lanes: int, width: float, length: float, furthest: float) -> None:
    """A rail for every swimmer, with a mark every arm's length."""
    strips = []
    for lane in range(lanes):
        x = (lane - 0.5 * (lanes - 1)) * width
        strips.append([[x, 0.0, 0.0], [x, -furthest, 0.0]])
        for mark in np.arange(0.0, furthest + length, length):
            strips.append([[x - 0.1 * width, -mark, 0.0], [x + 0.1 * width, -mark, 0.0]])
    lines = rr.LineStrips3D(strips, colors=[NEUTRAL.colour], radii=[length / 300])
    session.log("swim/arms/rails", lines, static=True)


def _layout(length: float, furthest: float, breadth: float) -> rrb.Blueprint:
    """The swimmers from above, forward to the top; their motions and ways; the search on its own time line."""
    middle = np.array([0.0, 0.5 * (length - furthest), 0.0])
    far = 1.1 * max(furthest + length, breadth)
    controls = rrb.EyeControls3D(
        position=middle + far * np.array([0.0, 0.3, -1.0]), look_target=middle, eye_up=[0, -1, 0]
    )
    space = rrb.Spatial3DView(origin="swim/arms", name="swimmers (3D)", eye_controls=controls, line_grid=False)
    signals = rrb.Vertical(lines_view("swim/theta", "servo angle [rad]"), lines_view("swim/travel", "way forward [cm]"))
    search = rrb.TimeSeriesView(origin="search", name="search: best so far, over gaits tried")
    return blueprint_page(rrb.Tabs(rrb.Horizontal(space, signals, column_shares=[5, 4], name="swim"), search))
