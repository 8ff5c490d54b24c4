"""Thrust over time: the load cell and what the models say it should read."""

from __future__ import annotations

from matplotlib.figure import Figure

from tentacle.signals import LoadCellSignal
from viz.figures.coordinates import shade_judged
from viz.figures.style import draw_line, house_style, legend_above, new_figure
from viz.palette import MEASURED
from viz.scene import ViewedRun


def thrust_figure(scene: ViewedRun, load_cell: LoadCellSignal | None) -> Figure | None:
    """Thrust [N] over time; None where nothing of it is known."""
    lines = [(party.role, scene.t, party.thrust) for party in scene.parties if party.thrust is not None]
    if load_cell is not None:
        lines.insert(0, (MEASURED, load_cell.t, load_cell.thrust))
    if not lines:
        return None
    with house_style():
        figure = new_figure(2.1)
        axes = figure.subplots()
        shade_judged(axes, scene)
        for role, t, thrust in lines:
            draw_line(axes, role, t, thrust)
        axes.set_xlabel("t [s]")
        axes.set_ylabel("thrust [N]")
        legend_above(figure, axes)
        return figure
