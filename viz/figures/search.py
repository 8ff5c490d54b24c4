"""A search for the best base motion: the best value found after so many evaluations, method by method."""

from __future__ import annotations

from collections.abc import Mapping

from matplotlib.figure import Figure

from tentacle.signals import Array
from viz.figures.motion import motion_roles
from viz.figures.style import draw_line, house_style, legend_above, new_figure


def search_figure(courses: Mapping[str, tuple[Array, Array]], quantity: str) -> Figure:
    """Best value so far (N,) over evaluations (N,) of up to five methods; quantity names it with its unit."""
    with house_style():
        figure = new_figure(2.4)
        axes = figure.subplots()
        for (name, (evaluations, best)), role in zip(
            courses.items(), motion_roles(list(courses)).values(), strict=True
        ):
            draw_line(axes, role, evaluations, best, name)
        axes.set_xlabel("evaluations [1]")
        axes.set_ylabel(f"best {quantity}")
        if len(courses) > 1:
            legend_above(figure, axes)
        return figure
