"""The arm's shape at a few instants: measured points, both models (the paper's Fig. 6b without the picture)."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from tentacle.diagnosis import RunComparison
from viz.figures.style import house_style, legend_above, new_figure
from viz.heat import residual_mm
from viz.palette import AUGMENTED, BASE, MEASURED

INSTANTS = 5


def instants(run: RunComparison, count: int = INSTANTS) -> list[int]:
    """Indices of `count` judged instants with measured points, spread over one swing: quantiles of the tip's x."""
    tip = int(np.argmax(run.s))
    usable = np.flatnonzero(run.judged & np.isfinite(residual_mm(run, run.base)).any(axis=1))
    if not len(usable):
        return []
    order = usable[np.argsort(np.nan_to_num(run.measured[usable, tip, 0]), kind="stable")]
    return [int(order[k]) for k in np.linspace(0, len(order) - 1, min(count, len(order))).round().astype(int)]


def shapes_figure(run: RunComparison) -> Figure:
    """One small panel an instant, equal scales, in mm, arm hanging from the origin."""
    with house_style():
        chosen = instants(run)
        figure = new_figure(2.7)
        panels = np.atleast_1d(figure.subplots(1, max(1, len(chosen)), sharex=True, sharey=True))
        style = "-" if run.points == "midline" else "."
        for axes, k in zip(panels, chosen, strict=False):
            axes.plot(*(1e3 * run.measured[k].T), "o", ms=2.4, color=MEASURED.hex, label=MEASURED.name)
            for role, xy in ((BASE, run.base), (AUGMENTED, run.augmented)):
                dash = role.dash if style == "-" else {"--": "x", "-.": "+"}[role.dash]
                axes.plot(*(1e3 * xy[k].T), dash, color=role.hex, label=role.name, ms=4)
            axes.set_title(f"t = {run.t[k]:.2f} s")
            axes.set_xlabel("x [mm]")
            axes.set_aspect("equal", adjustable="box")
        panels[0].set_ylabel("y along the straight arm [mm]")
        if chosen:
            panels[0].invert_yaxis()
            legend_above(figure, panels[0])
        return figure
