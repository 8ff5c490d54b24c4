"""The residual over arc length and time, every model on one colour scale."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from viz.figures.style import house_style, new_figure, thinned
from viz.heat import colour_limit
from viz.palette import SEQUENTIAL_MAP
from viz.scene import ViewedRun


def residual_figure(scene: ViewedRun) -> Figure:
    """Distance to the measured points [mm]; what is white was not measured."""
    with house_style():
        figure = new_figure(2.9)
        panels = np.atleast_1d(figure.subplots(1, len(scene.models), sharey=True))
        limit = colour_limit(scene)
        keep, order = thinned(len(scene.t), 700), np.argsort(scene.s, kind="stable")
        mesh = None
        for axes, party in zip(panels, scene.models, strict=True):
            values = scene.residual_mm(party)[keep][:, order].T
            if scene.points == "midline":
                mesh = axes.pcolormesh(
                    scene.t[keep],
                    scene.s[order],
                    values,
                    vmin=0.0,
                    vmax=limit,
                    cmap=SEQUENTIAL_MAP,
                    shading="nearest",
                    rasterized=True,
                )
                axes.set_ylabel("arc length s [1] (0 clamp, 1 tip)")
            else:  # markers may share an s: one row each
                mesh = axes.pcolormesh(
                    scene.t[keep], np.arange(len(order)), values, vmin=0.0, vmax=limit, cmap=SEQUENTIAL_MAP,
                    shading="nearest", rasterized=True,
                )  # fmt: skip
                axes.set_ylabel("marker, from clamp to tip")
                axes.set_yticks(np.arange(len(order)), [str(k + 1) for k in range(len(order))])
            axes.set_title(party.role.name)
            axes.set_xlabel("t [s]")
            axes.label_outer()
        if mesh is not None:
            figure.colorbar(mesh, ax=list(panels), label="distance to measured [mm]", extend="max")
        return figure
