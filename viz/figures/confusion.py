"""What was hidden against what was answered, as a map of shares with the counts written in."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from tentacle.signals import Array
from viz.figures.style import house_style, new_figure
from viz.palette import SEQUENTIAL_MAP
from viz.words import effect_name


def confusion_figure(truths: Sequence[str], answers: Sequence[str], counts: Array) -> Figure:
    """counts (R, C): trials of a row's truth that got a column's answer; colour is the share of the row."""
    with house_style():
        figure = new_figure(1.6 + 0.22 * len(truths), 2.2 + 0.24 * len(answers))
        axes = figure.subplots()
        shares = counts / np.maximum(counts.sum(axis=1, keepdims=True), 1.0)
        image = axes.imshow(shares, vmin=0, vmax=1, cmap=SEQUENTIAL_MAP, aspect="auto")
        axes.set_xticks(range(len(answers)), [effect_name(name) for name in answers], rotation=60, ha="right",
                        rotation_mode="anchor")  # fmt: skip
        axes.set_yticks(range(len(truths)), [effect_name(name) for name in truths])
        axes.set_xlabel("answer")
        axes.set_ylabel("hidden")
        for row, column in zip(*np.nonzero(counts), strict=True):
            ink = "black" if shares[row, column] > 0.6 else "white"
            axes.text(column, row, f"{counts[row, column]:.0f}", ha="center", va="center", fontsize=7, color=ink)
        figure.colorbar(image, ax=axes, label="share of the row [1]", shrink=0.8)
        return figure
