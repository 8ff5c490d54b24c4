"""Base motions over time (the left column of the paper's Fig. 10)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import cycle

from matplotlib.figure import Figure

from tentacle.signals import Array
from viz.figures.style import draw_line, house_style, legend_above, new_figure
from viz.palette import AUGMENTED, BASE, MEASURED, REFERENCE, WARNING, Role

SERIES_ROLES = (MEASURED, BASE, AUGMENTED, REFERENCE, WARNING)  # of lines that are no motions


def motion_roles(names: Sequence[str]) -> dict[str, Role]:
    """Who is drawn how: an optimised gait has one colour in every figure and session, whatever stands beside it."""
    others = cycle((BASE, MEASURED, REFERENCE, WARNING))
    return {name: AUGMENTED if name.startswith(("optimised", "best gait")) else next(others) for name in names}


def motion_figure(motions: Mapping[str, tuple[Array, Array]], height: float = 2.2, width: float = 7.2) -> Figure:
    """theta [rad] over t [s] of up to five named motions (t (T,), theta (T,))."""
    with house_style():
        figure = new_figure(height, width)
        axes = figure.subplots()
        roles = motion_roles(list(motions))
        for name, (t, theta) in motions.items():
            draw_line(axes, roles[name], t, theta, name)
        axes.set_xlabel("t [s]")
        axes.set_ylabel("base angle [rad]")
        if len(motions) > 1:
            legend_above(figure, axes)
        return figure
