"""The session of `tentacle optimise`: thrust over trials, method by method, and the base motion of the best."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from tentacle.signals import Array
from viz.figures.motion import ROLES, motion_figure
from viz.figures.style import png
from viz.palette import Role
from viz.session import session_file, session_id, set_layout

TRIAL = "trial"


@dataclass(frozen=True)
class Search:
    """One method's search: values (N,) reached when so many `evaluations` (N,) were done, and the best motion.

    values may be every trial's own, or the best so far now and then; NaN is a failed trial. The motion is theta (T,)
    [rad] at t (T,) [s].
    """

    evaluations: Array
    values: Array
    t: Array
    theta: Array

    @property
    def best_so_far(self) -> Array:
        """The best value (N,) up to each."""
        return np.fmax.accumulate(self.values)


def log_search(session: rr.RecordingStream, name: str, role: Role, search: Search) -> None:
    """Every value as a point, the best so far as a line."""
    trials = rr.TimeColumn(TRIAL, sequence=np.asarray(search.evaluations).astype(np.int64))
    points = rr.SeriesPoints(colors=[role.faint()], names=[f"{name}, trials"], marker_sizes=[2.0])
    where = f"search/{rr.escape_entity_path_part(name)}"
    session.log(f"{where}/trials", points, static=True)
    session.send_columns(f"{where}/trials", [trials], rr.Scalars.columns(scalars=search.values))
    session.log(f"{where}/best", rr.SeriesLines(colors=[role.colour], names=[f"{name}, best"]), static=True)
    session.send_columns(f"{where}/best", [trials], rr.Scalars.columns(scalars=search.best_so_far))


def optimise_blueprint(quantity: str) -> rrb.Blueprint:
    """The search, and the motions it found."""
    search = rrb.TimeSeriesView(origin="search", name=f"{quantity}, by trial")
    motion = rrb.Spatial2DView(origin="motion", name="base motion of the best")
    return rrb.Blueprint(
        rrb.Vertical(search, motion),
        rrb.TimePanel(state="collapsed", timeline=TRIAL),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        auto_views=False,
    )


def write_optimisation(searches: Mapping[str, Search], quantity: str, path: Path | str) -> Path:
    """The session of one or more searches for the largest `quantity` (name with unit, say "mean thrust [N]")."""
    path = Path(path)
    with session_file(path, session_id("optimise", quantity, *searches)) as session:
        for (name, search), role in zip(searches.items(), ROLES, strict=False):
            log_search(session, name, role, search)
        best = {name: (search.t, search.theta) for name, search in searches.items()}
        picture = png(motion_figure(best, height=2.6, width=8.0), dpi=150, ink="#dddddd", paper="#101010")
        session.log("motion", rr.EncodedImage(contents=picture, media_type="image/png"), static=True)
        set_layout(session, optimise_blueprint(quantity))
    return path
