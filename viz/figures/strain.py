"""Strain over time: the gauges and what the models say they should read."""

from __future__ import annotations

from matplotlib.figure import Figure

from viz.figures.coordinates import shade_judged
from viz.figures.style import draw_line, house_style, legend_above, new_figure
from viz.scene import ViewedRun


def strain_figure(scene: ViewedRun) -> Figure | None:
    """Strain about its mean [1e-3] over time, one row a gauge; None where there is no gauge."""
    if not scene.gauges:
        return None
    with house_style():
        figure = new_figure(0.6 + 1.5 * len(scene.gauges))
        rows = figure.subplots(len(scene.gauges), 1, sharex=True, squeeze=False)[:, 0]
        for k, (axes, gauge) in enumerate(zip(rows, scene.gauges, strict=True)):
            shade_judged(axes, scene)
            for party in scene.parties:
                if party.strain is not None:
                    draw_line(axes, party.role, scene.t, 1e3 * party.strain[:, k])
            axes.set_ylabel(f"{gauge} [1e-3]")
        rows[-1].set_xlabel("t [s]")
        legend_above(figure, rows[0])
        return figure
