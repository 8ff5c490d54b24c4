"""Table II's ratio as curves: over the edge of the thrust map, and over the friction of the rail."""

from __future__ import annotations

from matplotlib.figure import Figure

from tentacle.signals import Array
from viz.figures.motion import SERIES_ROLES
from viz.figures.style import draw_line, house_style, legend_above, new_figure


def ratio_figure(names: tuple[str, ...], panels: tuple[tuple[str, Array, Array, float], ...]) -> Figure:
    """A panel of each (label of x, x (X,), ratio (A, X) of the arms named, x taken in the table)."""
    with house_style():
        figure = new_figure(2.6)
        for axes, (label, x, ratios, taken) in zip(figure.subplots(1, len(panels), sharey=True), panels, strict=True):
            for name, ratio, role in zip(names, ratios, SERIES_ROLES, strict=False):
                draw_line(axes, role, x, ratio, name)
            axes.axvline(taken, color="0.6", linewidth=0.7)
            axes.set(xlabel=label, yscale="log", xscale="log")
            axes.set_xticks(x, [f"{value:g}" for value in x], minor=False)
            axes.minorticks_off()
            axes.set_yticks([1, 2, 5, 10, 20], ["1", "2", "5", "10", "20"])
        figure.axes[0].set_ylabel("optimised gait over best sine")
        legend_above(figure, figure.axes[0])
        return figure
