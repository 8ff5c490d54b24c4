"""Each trial's error before and after adding what was named, over the floor."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from tentacle.signals import Array
from viz.figures.style import house_style, new_figure
from viz.palette import AUGMENTED, BASE, NEUTRAL, WARNING


def error_drop_figure(before: Array, after: Array, floor: Array, right: Array) -> Figure:
    """before, after, floor (N,) [mm], right (N,) bool; drawn in the order of the error before."""
    with house_style():
        figure = new_figure(2.8)
        axes = figure.subplots()
        order = np.argsort(before / floor)
        x = np.arange(order.size)
        first, last, good = (before / floor)[order], (after / floor)[order], np.asarray(right, dtype=bool)[order]
        axes.vlines(x, np.minimum(first, last), np.maximum(first, last), color=NEUTRAL.hex, lw=0.6)
        axes.plot(x, first, "^", color=BASE.hex, ms=4, label="before")
        axes.plot(x[good], last[good], "o", color=AUGMENTED.hex, ms=4, label="after, answer right")
        axes.plot(x[~good], last[~good], "x", color=WARNING.hex, ms=5, label="after, answer wrong")
        axes.axhline(1.0, color=NEUTRAL.hex, lw=0.8)
        axes.axhline(1.2, color=NEUTRAL.hex, lw=0.8, ls=":")
        axes.set_yscale("log")
        axes.set_xlabel("trial, by its error before")
        axes.set_ylabel("error over floor [1]")
        figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=3)
        return figure
