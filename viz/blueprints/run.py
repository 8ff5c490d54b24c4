"""The page of one run, the same for every verb: video and arms on the left, then signals, then residuals."""

from __future__ import annotations

from dataclasses import dataclass

import rerun.blueprint as rrb

from tentacle.diagnosis import Quantity
from tentacle.recording import Declaration
from viz.blueprints.views import camera_view, events_view, lines_view, space_view, tip_view
from viz.topics.paths import run_path, sensor_path

UNITS: dict[Quantity, str] = {"strain": "strain", "acceleration": "m/s^2"}


@dataclass(frozen=True)
class LoggedTopics:
    """The logged topics of a run: its models (key, name), its sensors (name, quantity), and which of the optional
    topics.
    """

    name: str
    declaration: Declaration
    models: tuple[tuple[str, str], ...]
    arms: bool
    coordinates: bool
    camera: bool
    thrust: bool
    events: bool
    forces: str = ""  # what the force arrows' lengths mean
    tip_mm: float = 0.0  # how far the enlarged view of the tip reaches; 0: there is none
    sensors: tuple[tuple[str, Quantity], ...] = ()


def residual_view(path: str, key: str, title: str) -> rrb.Spatial2DView:
    """One model's residual map."""
    bounds = rrb.VisualBounds2D(x_range=(-150.0, 640.0), y_range=(-130.0, 420.0))
    return rrb.Spatial2DView(origin=f"{path}/residual/{key}", name=title, visual_bounds=bounds)


def run_page(shown: LoggedTopics) -> rrb.Container:
    """The views of one run."""
    path = run_path(shown.name)
    seen: list[rrb.View] = [camera_view(path)] if shown.camera else []
    if shown.arms:
        name = f"arms (3D); {shown.forces}" if shown.forces else "arms (3D)"
        seen.append(space_view(path, shown.declaration, name))
    signals: list[rrb.View | rrb.Container] = [lines_view(f"{path}/theta", "servo angle [rad]")]
    if shown.coordinates:
        signals = [lines_view(f"{path}/q{index}", f"q{index} [rad]") for index in (1, 2)]
    if shown.models:
        signals.append(lines_view(f"{path}/error", "distance, rms along the arm [mm]"))
    if shown.thrust:
        signals.append(lines_view(f"{path}/thrust", "thrust [N]"))
    read = [
        lines_view(sensor_path(path, quantity, name), f"{name} [{UNITS[quantity]}]") for name, quantity in shown.sensors
    ]
    if read:
        signals.append(rrb.Tabs(*read))
    last: list[rrb.View] = [lines_view(f"{path}/theta", "servo angle [rad]")] if shown.coordinates else []
    if shown.events:
        last.insert(0, events_view(path))
    right: list[rrb.View | rrb.Container] = []
    if shown.arms:
        spectra = rrb.Spatial2DView(origin=f"{path}/spectrum", name="spectra of the tip")
        right.append(rrb.Tabs(tip_view(path, shown.tip_mm), spectra) if shown.tip_mm > 0.0 else spectra)
    if last:
        right.append(rrb.Tabs(*last))
    if shown.models:
        right.insert(0, rrb.Tabs(*(residual_view(path, key, f"residual, {name}") for key, name in shown.models)))
    columns = [(rrb.Vertical(*views), share) for views, share in ((seen, 6), (signals, 4), (right, 4)) if views]
    return rrb.Horizontal(
        *(column for column, _ in columns), column_shares=[share for _, share in columns], name=shown.name
    )
