"""Mean thrust over amplitude and frequency of a sine at the base, measured and modelled (the paper's Fig. 9)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from tentacle.signals import Array
from viz.figures.style import house_style, new_figure
from viz.palette import SEQUENTIAL_MAP


@dataclass(frozen=True)
class ThrustMap:
    """One arm: amplitude (A,) [rad], frequency (F,) [Hz], mean thrust (A, F) [N]; NaN where unknown."""

    name: str
    amplitude: Array
    frequency: Array
    modelled: Array
    measured: Array | None = None


def draw_map(axes: Axes, arm: ThrustMap, thrust: Array, limits: tuple[float, float], title: str) -> None:
    """One map [mN] on the colour limits of all."""
    cells = np.arange(len(arm.frequency)), np.arange(len(arm.amplitude))
    edges = [np.arange(len(along) + 1) - 0.5 for along in cells]
    axes.pcolormesh(*edges, 1e3 * thrust, cmap=SEQUENTIAL_MAP, rasterized=True, vmin=limits[0], vmax=limits[1])
    axes.set_xticks(cells[0], [f"{f:.3g}" for f in arm.frequency], rotation=60 if len(cells[0]) > 6 else 0)
    axes.set_yticks(cells[1], [f"{a:.3g}" for a in arm.amplitude])
    axes.set_xlabel("frequency [Hz]")
    axes.set_ylabel("amplitude [rad]")
    axes.set_title(title)


def thrust_map_figure(arms: Sequence[ThrustMap]) -> Figure:
    """A column an arm, one colour scale [mN] for all, so that measured and modelled can be compared."""
    with house_style():
        maps = [m for arm in arms for m in (arm.measured, arm.modelled) if m is not None]
        values = 1e3 * np.concatenate([m[np.isfinite(m)] for m in maps])
        limits = (min(0.0, float(values.min())), float(values.max())) if values.size else (0.0, 1.0)
        rows = 2 if any(arm.measured is not None for arm in arms) else 1
        figure = new_figure(0.4 + 2.2 * rows)
        panels = figure.subplots(rows, len(arms), squeeze=False)
        for column, arm in enumerate(arms):
            if arm.measured is not None:
                draw_map(panels[0, column], arm, arm.measured, limits, f"{arm.name}, measured")
            elif rows == 2:
                panels[0, column].set_axis_off()
            draw_map(panels[-1, column], arm, arm.modelled, limits, f"{arm.name}, model")
        colours = panels[-1, 0].collections[0]
        figure.colorbar(colours, ax=list(panels.flat), label="mean forward thrust [mN]")
        return figure
