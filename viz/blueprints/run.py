"""The page of one run, the same for every verb: what is seen on the left, then signals, then residuals."""

from __future__ import annotations

from dataclasses import dataclass

import rerun.blueprint as rrb

from tentacle.recording import Declaration
from viz.blueprints.views import camera_view, events_view, lines_view, space_view
from viz.topics.paths import run_path


@dataclass(frozen=True)
class Shown:
    """What was logged of a run: its models (key, name), and which of the optional topics."""

    name: str
    declaration: Declaration
    models: tuple[tuple[str, str], ...]
    camera: bool
    thrust: bool
    events: bool


def residual_view(path: str, key: str, title: str) -> rrb.Spatial2DView:
    """One model's residual map."""
    bounds = rrb.VisualBounds2D(x_range=(-80.0, 640.0), y_range=(-40.0, 370.0))
    return rrb.Spatial2DView(origin=f"{path}/residual/{key}", name=title, visual_bounds=bounds)


def run_page(shown: Shown) -> rrb.Container:
    """The views of one run."""
    path = run_path(shown.name)
    seen: list[rrb.View] = [space_view(path, shown.declaration)]
    if shown.camera:
        seen.insert(0, camera_view(path))
    signals = [lines_view(f"{path}/q1", "q1 [rad]"), lines_view(f"{path}/q2", "q2 [rad]")]
    if shown.models:
        signals.append(lines_view(f"{path}/error", "distance, rms along the arm [mm]"))
    if shown.thrust:
        signals.append(lines_view(f"{path}/thrust", "thrust [N]"))
    last: list[rrb.View] = [lines_view(f"{path}/theta", "servo angle [rad]")]
    if shown.events:
        last.insert(0, events_view(path))
    right: list[rrb.View | rrb.Container] = [
        rrb.Spatial2DView(origin=f"{path}/spectrum", name="spectra of the tip"),
        rrb.Tabs(*last),
    ]
    if shown.models:
        right.insert(0, rrb.Tabs(*(residual_view(path, key, f"residual, {name}") for key, name in shown.models)))
    return rrb.Horizontal(
        rrb.Vertical(*seen), rrb.Vertical(*signals), rrb.Vertical(*right), column_shares=[5, 5, 4], name=shown.name
    )
