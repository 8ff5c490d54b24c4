"""The front of speed against power, and where named gaits stand beside it."""

from __future__ import annotations

from collections.abc import Mapping

from matplotlib.figure import Figure

from tentacle.signals import Array
from viz.figures.motion import motion_roles
from viz.figures.style import house_style, legend_above, new_figure
from viz.palette import NEUTRAL


def front_figure(speed: Array, power: Array, marks: Mapping[str, tuple[float, float]]) -> Figure:
    """The front: speed (P,) [m/s] over power (P,) [W]; marks are up to four named gaits (speed, power).

    The front is grey: a gait has the colour that it has in the same report's other figures.
    """
    with house_style():
        figure = new_figure(2.6)
        axes = figure.subplots()
        axes.plot(1e3 * power, 100.0 * speed, color=NEUTRAL.hex, marker=".", label="front")
        for (name, (fast, costly)), marker, role in zip(
            marks.items(), "so^v", motion_roles(list(marks)).values(), strict=False
        ):
            axes.plot(1e3 * costly, 100.0 * fast, marker=marker, linestyle="none", color=role.hex, label=name)
        axes.set_xlabel("power to the arm [mW]")
        axes.set_ylabel("speed [cm/s]")
        legend_above(figure, axes)
    return figure
