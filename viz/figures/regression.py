"""Both sides of the regression, delta and Y pi of eq. 18, and the simulated motion (the paper's Fig. 5)."""

from __future__ import annotations

from matplotlib.figure import Figure

from tentacle.signals import Array
from viz.figures.style import draw_line, house_style, legend_above, new_figure
from viz.palette import BASE, MEASURED
from viz.scene import ViewedRun


def regression_figure(t: Array, delta: Array, prediction: Array, scene: ViewedRun) -> Figure:
    """delta, prediction = Y pi (T, 2) [N m] at t (T,); right, q of the scene's subject and of its first model."""
    with house_style():
        figure = new_figure(3.6)
        panels = figure.subplots(2, 2, sharex=True)
        for index in range(2):
            left, right = panels[index]
            draw_line(left, MEASURED, t, 1e3 * delta[:, index], "measured")
            draw_line(left, BASE, t, 1e3 * prediction[:, index], "model")
            left.set_ylabel(f"row {index + 1} [mN m]")
            for party in (scene.subject, scene.models[0]):
                if party.q is not None:
                    draw_line(right, party.role, scene.t, party.q[:, index])
            right.set_ylabel(f"q{index + 1} [rad]")
        for axes in panels[-1]:
            axes.set_xlabel("t [s]")
        panels[0, 0].set_title("delta and Y pi (eq. 18)")
        panels[0, 1].set_title("open-loop simulation")
        legend_above(figure, panels[0, 0])
        return figure
