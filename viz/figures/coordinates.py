"""q1, q2 over time, measured against both models (the paper's Fig. 5, right, and Fig. 8)."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tentacle.diagnosis import RunComparison
from viz.figures.style import draw, house_style, legend_above, new_figure
from viz.palette import AUGMENTED, BASE, MEASURED, NEUTRAL


def shade_judged(axes: Axes, run: RunComparison) -> None:
    """Mark where the errors are judged, unless that is everywhere."""
    if run.judged.all() or not run.judged.any():
        return
    edges = np.flatnonzero(np.diff(np.concatenate([[False], run.judged, [False]]).astype(int)))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        axes.axvspan(float(run.t[first]), float(run.t[last - 1]), color=NEUTRAL.hex, alpha=0.18, lw=0)


def coordinates_figure(run: RunComparison) -> Figure:
    """Two panels over one time axis; grey where the errors are judged."""
    with house_style():
        figure = new_figure(3.4)
        panels = figure.subplots(2, 1, sharex=True)
        for index, axes in enumerate(panels):
            shade_judged(axes, run)
            draw(axes, MEASURED, run.t, run.q_measured[:, index])
            draw(axes, BASE, run.t, run.q_base[:, index])
            draw(axes, AUGMENTED, run.t, run.q_augmented[:, index])
            axes.set_ylabel(f"q{index + 1} [rad]")
        panels[-1].set_xlabel("t [s]")
        legend_above(figure, panels[0])
        return figure
