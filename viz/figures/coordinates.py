"""q1, q2 over time, measured and modelled (the paper's Fig. 5, right, and Fig. 8)."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from viz.figures.style import draw_line, house_style, legend_above, new_figure
from viz.palette import NEUTRAL
from viz.scene import ViewedRun


def shade_judged(axes: Axes, scene: ViewedRun) -> None:
    """Mark where the errors are judged, unless that is everywhere."""
    if scene.judged.all() or not scene.judged.any():
        return
    edges = np.flatnonzero(np.diff(np.concatenate([[False], scene.judged, [False]]).astype(int)))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        axes.axvspan(float(scene.t[first]), float(scene.t[last - 1]), color=NEUTRAL.hex, alpha=0.18, lw=0)


def coordinates_figure(scene: ViewedRun) -> Figure:
    """Two panels over one time axis; grey where the errors are judged."""
    with house_style():
        figure = new_figure(3.4)
        panels = figure.subplots(2, 1, sharex=True)
        for index, axes in enumerate(panels):
            shade_judged(axes, scene)
            for party in scene.parties:
                if party.q is not None:
                    draw_line(axes, party.role, scene.t, party.q[:, index])
            axes.set_ylabel(f"q{index + 1} [rad]")
        panels[-1].set_xlabel("t [s]")
        legend_above(figure, panels[0])
        return figure
