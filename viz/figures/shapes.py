"""The arm's shape at a few instants: measured points, models (the paper's Fig. 6b without the picture)."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from viz.figures.style import house_style, legend_above, new_figure
from viz.scene import ViewedRun

INSTANTS = 5


def instants(scene: ViewedRun, count: int = INSTANTS) -> list[int]:
    """Indices of `count` judged instants with measured points, spread over one swing: quantiles of the tip's x."""
    usable = np.flatnonzero(scene.judged & np.isfinite(scene.subject.xy).any(axis=(1, 2)))
    if not len(usable):
        return []
    order = usable[np.argsort(np.nan_to_num(scene.subject.xy[usable, scene.tip, 0]), kind="stable")]
    return [int(order[k]) for k in np.linspace(0, len(order) - 1, min(count, len(order))).round().astype(int)]


def shapes_figure(scene: ViewedRun) -> Figure:
    """One small panel an instant, equal scales, in mm, arm hanging from the origin."""
    with house_style():
        chosen = instants(scene)
        figure = new_figure(2.7)
        panels = np.atleast_1d(figure.subplots(1, max(1, len(chosen)), sharex=True, sharey=True))
        for axes, k in zip(panels, chosen, strict=False):
            subject = scene.subject
            axes.plot(*(1e3 * subject.xy[k].T), "o", ms=2.4, color=subject.role.hex, label=subject.role.name)
            for party, cross in zip(scene.models, "x+1", strict=False):
                dash = party.role.dash if scene.points == "midline" else cross
                axes.plot(*(1e3 * party.xy[k].T), dash, color=party.role.hex, label=party.role.name, ms=4)
            axes.set_title(f"t = {scene.t[k]:.2f} s")
            axes.set_xlabel("x [mm]")
            axes.set_aspect("equal", adjustable="box")
        panels[0].set_ylabel("y along the straight arm [mm]")
        if chosen:
            panels[0].invert_yaxis()
            legend_above(figure, panels[0])
        return figure
