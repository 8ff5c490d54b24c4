"""The residual over arc length and time, both models on one colour scale."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from tentacle.diagnosis import RunComparison
from viz.figures.style import house_style, new_figure, thinned
from viz.heat import colour_limit, residual_mm
from viz.palette import AUGMENTED, BASE, SEQUENTIAL_MAP


def residual_figure(run: RunComparison) -> Figure:
    """Distance to the measured points [mm]; what is white was not measured."""
    with house_style():
        figure = new_figure(2.9)
        panels = figure.subplots(1, 2, sharey=True)
        limit = colour_limit(run)
        keep, order = thinned(len(run.t), 700), np.argsort(run.s, kind="stable")
        mesh = None
        for axes, role, model in zip(panels, (BASE, AUGMENTED), (run.base, run.augmented), strict=True):
            values = residual_mm(run, model)[keep][:, order].T
            if run.points == "midline":
                mesh = axes.pcolormesh(
                    run.t[keep],
                    run.s[order],
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
                    run.t[keep], np.arange(len(order)), values, vmin=0.0, vmax=limit, cmap=SEQUENTIAL_MAP,
                    shading="nearest", rasterized=True,
                )  # fmt: skip
                axes.set_ylabel("marker, from clamp to tip")
            axes.set_title(role.name)
            axes.set_xlabel("t [s]")
            axes.label_outer()
        if mesh is not None:
            figure.colorbar(mesh, ax=panels, label="distance to measured [mm]", extend="max")
        return figure
