"""Sensors over time: what each of them reads and what the models say it should read."""

from __future__ import annotations

from matplotlib.figure import Figure

from tentacle.diagnosis import Quantity
from viz.figures.coordinates import shade_judged
from viz.figures.style import draw_line, house_style, legend_above, new_figure
from viz.scene import ViewedRun

SHOWN: dict[Quantity, tuple[float, str]] = {"strain": (1e3, "1e-3"), "acceleration": (1.0, "m/s\u00b2")}


def sensors_figure(scene: ViewedRun, quantity: Quantity) -> Figure | None:
    """Readings about their mean over time, one row a sensor of that quantity; None where there is none."""
    chosen = [k for k, (_, own) in enumerate(scene.sensors) if own == quantity]
    if not chosen:
        return None
    factor, unit = SHOWN[quantity]
    with house_style():
        figure = new_figure(0.6 + 1.5 * len(chosen))
        rows = figure.subplots(len(chosen), 1, sharex=True, squeeze=False)[:, 0]
        for axes, k in zip(rows, chosen, strict=True):
            shade_judged(axes, scene)
            for party in scene.parties:
                if party.sensors:
                    draw_line(axes, party.role, scene.t, factor * party.sensors[k])
            axes.set_ylabel(f"{scene.sensors[k][0]} [{unit}]")
        rows[-1].set_xlabel("t [s]")
        legend_above(figure, rows[0])
        return figure
