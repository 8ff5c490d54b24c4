"""Effects that these recordings hardly separate: cosines of their sensitivities, base parameters projected out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from tentacle.signals import Array
from viz.figures.style import house_style, new_figure
from viz.palette import SEQUENTIAL_MAP
from viz.words import effect_name


def twins_figure(names: Sequence[str], cosines: Array) -> Figure:
    """|cos| (N, N) as a map with its numbers; 1 means twins."""
    with house_style():
        count = len(names)
        figure = new_figure(1.3 + 0.26 * count, min(7.2, 2.6 + 0.3 * count))
        axes = figure.subplots()
        size = np.abs(cosines)
        image = axes.imshow(size, vmin=0, vmax=1, cmap=SEQUENTIAL_MAP)
        labels = [effect_name(name) for name in names]
        axes.set_xticks(range(count), labels, rotation=60, ha="right", rotation_mode="anchor")
        axes.set_yticks(range(count), labels)
        for row in range(count):
            for column in range(count):
                value = size[row, column]
                if row != column and value >= 0.5:
                    ink = "black" if value > 0.6 else "white"
                    axes.text(
                        column,
                        row,
                        (f"{value:.3f}" if value > 0.99 else f"{value:.2f}").lstrip("0"),
                        ha="center",
                        va="center",
                        fontsize=6,
                        color=ink,
                    )
        figure.colorbar(image, ax=axes, label="|cos| of sensitivities [1]", shrink=0.8)
        return figure
