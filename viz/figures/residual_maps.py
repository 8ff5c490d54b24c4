"""Small multiples: every recording's residual over arc length and time, on one colour scale."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from tentacle.signals import Array
from viz.figures.style import house_style, new_figure
from viz.palette import SEQUENTIAL_MAP

COLUMNS, PANEL_HEIGHT = 6, 0.95


def residual_maps_figure(maps: Sequence[tuple[str, Array]]) -> Figure | None:
    """A panel for every (name, (places, times) [mm]), base below; None where there is none."""
    if not maps:
        return None
    rows = -(-len(maps) // COLUMNS)
    with house_style():
        figure = new_figure(PANEL_HEIGHT * rows + 0.7)
        panels = np.ravel(figure.subplots(rows, COLUMNS, squeeze=False))
        everything = np.concatenate([values.ravel() for _, values in maps])
        limit = float(np.nanpercentile(everything, 98)) if np.isfinite(everything).any() else 1.0
        shown = None
        for axes, (name, values) in zip(panels, maps, strict=False):
            shown = axes.imshow(
                values, origin="lower", aspect="auto", vmin=0.0, vmax=limit, cmap=SEQUENTIAL_MAP, rasterized=True
            )
            axes.set_title(name, fontsize=6)
            axes.set_xticks([])
            axes.set_yticks([])
        for axes in panels[len(maps) :]:
            axes.remove()
        if shown is not None:
            figure.colorbar(shown, ax=list(panels[: len(maps)]), label="left [mm]", extend="max", shrink=0.8, aspect=40)
        return figure
