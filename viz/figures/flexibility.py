"""The reduced model's error over drag / stiffness, of several arms, one point a driven motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from tentacle.signals import Array
from viz.figures.style import INK, house_style, new_figure
from viz.palette import NEUTRAL, SEQUENTIAL_MAP

TAPER_SYMBOLS = "osDv^P*X"
LEAST_ERROR = 1e-4


def flexibility_figure(
    frequency_ratio: Sequence[float],
    flexibility: Mapping[str, Array],
    errors: Mapping[str, Mapping[str, Array]],
    levels: Sequence[float],
) -> Figure:
    """A panel a title of errors; in it (A, F) errors of each arm over its (A, F) flexibility, dashed lines at levels.

    An arm has its marker (eight of them), a frequency ratio its colour; NaN errors are left out.
    """
    with house_style():
        figure = new_figure(3.0)
        panels = figure.subplots(1, len(errors), squeeze=False, sharex=True, sharey=True)[0]
        colours = LogNorm(min(frequency_ratio), max(frequency_ratio))
        shown = None
        for panel, (title, arms) in zip(panels, errors.items(), strict=True):
            for (arm, error), marker in zip(arms.items(), TAPER_SYMBOLS, strict=False):
                ratios = np.broadcast_to(np.asarray(frequency_ratio, dtype=float), error.shape)
                shown = panel.scatter(
                    flexibility[arm], np.maximum(error, LEAST_ERROR), c=ratios, s=12, marker=marker, norm=colours,
                    cmap=SEQUENTIAL_MAP, linewidths=0.4, edgecolors=INK,
                )  # fmt: skip
            for level in levels:
                panel.axhline(level, color=INK, linewidth=0.7, linestyle="--")
                panel.annotate(f"{100 * level:.0f} %", (0.02, level), xycoords=("axes fraction", "data"), va="bottom",
                               fontsize=7)  # fmt: skip
            panel.set_xscale("log")
            panel.set_yscale("log")
            panel.set_title(title)
            panel.set_xlabel("drag / stiffness")
        panels[0].set_ylabel("relative error")
        arms = next(iter(errors.values()))
        handles = [
            Line2D([], [], color=NEUTRAL.hex, marker=marker, linestyle="", markersize=4, label=arm)
            for arm, marker in zip(arms, TAPER_SYMBOLS, strict=False)
        ]
        figure.legend(handles=handles, loc="outside upper center", ncols=min(3, len(handles)))
        if shown is not None:
            bar = figure.colorbar(shown, ax=list(panels), label="frequency / first mode")
            bar.set_ticks(list(frequency_ratio), labels=[f"{ratio:g}" for ratio in frequency_ratio])
            bar.minorticks_off()
        return figure
