"""Base motions over time (the left column of the paper's Fig. 10)."""

from __future__ import annotations

from collections.abc import Mapping

from matplotlib.figure import Figure

from tentacle.signals import Array
from viz.figures.style import draw_line, house_style, legend_above, new_figure
from viz.palette import AUGMENTED, BASE, MEASURED, REFERENCE, WARNING

MOTION_ROLES = (MEASURED, BASE, AUGMENTED, REFERENCE, WARNING)


def motion_figure(motions: Mapping[str, tuple[Array, Array]], height: float = 2.2, width: float = 7.2) -> Figure:
    """theta [rad] over t [s] of up to five named motions (t (T,), theta (T,))."""
    with house_style():
        figure = new_figure(height, width)
        axes = figure.subplots()
        for (name, (t, theta)), role in zip(motions.items(), MOTION_ROLES, strict=False):
            draw_line(axes, role, t, theta, name)
        axes.set_xlabel("t [s]")
        axes.set_ylabel("base angle [rad]")
        if len(motions) > 1:
            legend_above(figure, axes)
        return figure
