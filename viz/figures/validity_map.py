"""The range of validity of a reduced model: its relative error over driving frequency and amplitude, with
level lines.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from tentacle.signals import Array
from viz.figures.style import house_style, new_figure
from viz.palette import SEQUENTIAL_MAP

LIMITS = (1e-3, 1.0)


def validity_figure(
    frequency_ratio: Sequence[float], amplitude: Sequence[float], errors: Mapping[str, Array], levels: Sequence[float]
) -> Figure:
    """A panel a row of errors (title -> (A, F), NaN where unknown); lines where the error passes the levels."""
    with house_style():
        columns = min(3, len(errors))
        rows = -(-len(errors) // columns)
        figure = new_figure(0.5 + 2.1 * rows)
        panels = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
        x, y = np.log10(frequency_ratio), np.log10(amplitude)
        colours = None
        for panel, (title, error) in zip(panels.flat, errors.items(), strict=False):
            shown = np.ma.masked_invalid(np.clip(error, *LIMITS))
            colours = panel.pcolormesh(
                x, y, shown, shading="nearest", cmap=SEQUENTIAL_MAP, norm=LogNorm(*LIMITS), rasterized=True
            )
            known = error[np.isfinite(error)]
            crossed = [level for level in levels if known.size and known.min() < level < known.max()]
            if crossed:
                lines = panel.contour(
                    x, y, np.log10(np.where(np.isfinite(error), np.maximum(error, LIMITS[0]), np.nan)),
                    levels=np.log10(crossed), colors="white", linewidths=1.3, linestyles="solid",
                )  # fmt: skip
                panel.clabel(lines, fmt={np.log10(v): f"{100 * v:.0f} %" for v in crossed}, fontsize=7)
            panel.set_title(title)
            panel.set_xticks(x, [f"{v:.2g}" for v in frequency_ratio])
            panel.set_yticks(y, [f"{v:.2g}" for v in amplitude])
        for panel in panels[:, 0]:
            panel.set_ylabel("amplitude [rad]")
        for panel in panels[-1]:
            panel.set_xlabel("frequency / first mode")
        for panel in list(panels.flat)[len(errors) :]:
            panel.set_axis_off()
        if colours is not None:
            figure.colorbar(colours, ax=list(panels.flat), label="relative error")
        return figure
