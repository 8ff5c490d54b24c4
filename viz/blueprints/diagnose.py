"""diagnose: the verdict beside each run's camera, arms, coordinates, residual, spectra and thrust."""

from __future__ import annotations

from dataclasses import dataclass

import rerun.blueprint as rrb

from tentacle.recording import Declaration
from viz.blueprints.views import camera_view, events_view, lines_view, page, space_view
from viz.topics.paths import run_path


@dataclass(frozen=True)
class Shown:
    """Which of a run's optional topics were logged."""

    name: str
    declaration: Declaration
    camera: bool
    thrust: bool
    events: bool


def residual_view(path: str, name: str, title: str) -> rrb.Spatial2DView:
    """One model's residual map."""
    bounds = rrb.VisualBounds2D(x_range=(-80.0, 640.0), y_range=(-40.0, 370.0))
    return rrb.Spatial2DView(origin=f"{path}/residual/{name}", name=title, visual_bounds=bounds)


def run_page(shown: Shown) -> rrb.Container:
    """The views of one run: what is seen on the left, signals in the middle and right."""
    path = run_path(shown.name)
    seen: list[rrb.View] = [space_view(path, shown.declaration)]
    if shown.camera:
        seen.insert(0, camera_view(path))
    last: list[rrb.View] = [lines_view(f"{path}/theta", "servo angle [rad]")]
    if shown.events:
        last.insert(0, events_view(path))
    signals = [
        lines_view(f"{path}/q1", "q1 [rad]"),
        lines_view(f"{path}/q2", "q2 [rad]"),
        lines_view(f"{path}/error", "distance to measured, rms along the arm [mm]"),
    ]
    if shown.thrust:
        signals.append(lines_view(f"{path}/thrust", "thrust [N]"))
    residuals = [
        rrb.Tabs(
            residual_view(path, "base", "residual, base model"),
            residual_view(path, "augmented", "residual, augmented model"),
        ),
        rrb.Spatial2DView(origin=f"{path}/spectrum", name="spectra of the tip"),
        rrb.Tabs(*last),
    ]
    return rrb.Horizontal(
        rrb.Vertical(*seen), rrb.Vertical(*signals), rrb.Vertical(*residuals), column_shares=[5, 5, 4], name=shown.name
    )


def diagnose_blueprint(runs: list[Shown]) -> rrb.Blueprint:
    """The verdict on the left, a tab for each run."""
    pages = [run_page(shown) for shown in runs]
    verdict = rrb.TextDocumentView(origin="verdict", name="verdict")
    return page(rrb.Horizontal(verdict, rrb.Tabs(*pages), column_shares=[1, 3]))
