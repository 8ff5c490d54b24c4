"""Work and precision: processor time over error, by program and by case."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from viz.figures.motion import SERIES_ROLES
from viz.figures.style import house_style, new_figure
from viz.palette import NEUTRAL

PROGRAM_ROLES = (*SERIES_ROLES, NEUTRAL)  # of up to six programs


def frontier(points: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """The (error, cost) that no other point of the program beats in both, by rising error."""
    kept: list[tuple[float, float]] = []
    for error, cost in sorted(points):
        if not kept or cost < kept[-1][1]:
            kept.append((error, cost))
    return kept


def _labelled(axes: Axes) -> Iterator[tuple[Any, str]]:
    """The lines of a panel with their labels."""
    lines, labels = axes.get_legend_handles_labels()
    return zip(lines, labels, strict=True)


def work_precision_figure(cases: Mapping[str, Mapping[str, Sequence[tuple[float, float]]]]) -> Figure:
    """A panel for every case: of every program, its points (error, seconds of processor a simulated second), and the
    line through the best of them.
    """
    columns = min(4, len(cases))
    rows = -(-len(cases) // columns)
    with house_style():
        figure = new_figure(max(1.75 * rows + 0.5, 3.2))  # one row holds the label beside it
        panels = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
        for axes, (name, programs) in zip(panels.flat, cases.items(), strict=False):
            for (program, points), role in zip(programs.items(), PROGRAM_ROLES, strict=False):
                best = frontier(points)
                if best:
                    axes.plot(*zip(*points, strict=True), ".", color=role.hex, markersize=2, alpha=0.35)
                    axes.plot(*zip(*best, strict=True), role.dash, color=role.hex, label=program)
            axes.set(xscale="log", yscale="log", title=name, xlim=(1e-4, 0.3))
        for axes in list(panels.flat)[len(cases) :]:
            axes.set_visible(False)
        figure.supxlabel("error of midline and mean thrust", fontsize=9)
        figure.supylabel("processor time a simulated second [s]", fontsize=9)
        lines = {label: line for axes in panels.flat for line, label in _labelled(axes)}
        figure.legend(list(lines.values()), list(lines), loc="outside upper center", ncols=4)
        return figure
