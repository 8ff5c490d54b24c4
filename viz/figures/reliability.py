"""The reliability curve: confidence as stated against the share of such answers that was right."""

from __future__ import annotations

from matplotlib.figure import Figure

from tentacle.signals import Array
from viz.figures.style import house_style, new_figure
from viz.palette import AUGMENTED, NEUTRAL


def reliability_figure(stated: Array, right: Array, low: Array, high: Array, counts: Array) -> Figure:
    """A point a bin: stated confidence (N,), share right (N,) with its interval low .. high, counts (N,) beside it."""
    with house_style():
        figure = new_figure(3.4, 3.6)
        axes = figure.subplots()
        axes.plot([0, 1], [0, 1], NEUTRAL.dash, color=NEUTRAL.hex, lw=0.8, label="as stated")
        axes.vlines(stated, low, high, color=AUGMENTED.hex, lw=1)
        axes.plot(stated, right, "o", color=AUGMENTED.hex, ms=4, label="right (bar: 95 % interval)")
        for x, y, count in zip(stated, right, counts, strict=True):
            axes.annotate(f"{count:.0f}", (x, y), (5, -3), textcoords="offset points", fontsize=7)
        axes.set_xlim(0, 1.02)
        axes.set_ylim(0, 1.02)
        axes.set_xlabel("confidence [1]")
        axes.set_ylabel("share right [1]")
        figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center")
        return figure
