"""How a search went: the best so far over what was tried, and the front of speed against power."""

from __future__ import annotations

from collections.abc import Mapping

from matplotlib.figure import Figure

from tentacle.signals import Array
from viz.figures.motion import ROLES
from viz.figures.style import INK, draw, house_style, legend_above, new_figure


def convergence_figure(
    courses: Mapping[str, tuple[Array, Array]], quantity: str, baseline: float, baseline_name: str
) -> Figure:
    """Best so far (G,) over evaluations (G,) of every named search; quantity is name and unit."""
    with house_style():
        figure = new_figure(2.4)
        axes = figure.subplots()
        for (name, (evaluations, best)), role in zip(courses.items(), ROLES, strict=False):
            draw(axes, role, evaluations, best, name)
        axes.axhline(baseline, color=INK, linewidth=0.8, linestyle=":", label=baseline_name)
        axes.set_xlabel("gaits tried")
        axes.set_ylabel(quantity)
        legend_above(figure, axes)
    return figure


def front_figure(speed: Array, power: Array, marks: Mapping[str, tuple[float, float]]) -> Figure:
    """The front: speed (P,) [m/s] over power (P,) [W]; marks are named gaits (speed, power)."""
    with house_style():
        figure = new_figure(2.6)
        axes = figure.subplots()
        axes.plot(1e3 * power, 100.0 * speed, color=ROLES[0].hex, marker=".", label="front")
        for (name, (fast, costly)), marker, role in zip(marks.items(), "so^v", ROLES[1:], strict=False):
            axes.plot(1e3 * costly, 100.0 * fast, marker=marker, linestyle="none", color=role.hex, label=name)
        axes.set_xlabel("power to the arm [mW]")
        axes.set_ylabel("speed [cm/s]")
        legend_above(figure, axes)
    return figure
