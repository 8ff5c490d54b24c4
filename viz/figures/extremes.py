"""The worst and the best reconstruction among several recordings (the paper's Fig. 8)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from tentacle.signals import Array
from viz.figures.style import draw_line, house_style, legend_above, new_figure
from viz.scene import ViewedRun


def mean_square_error(scene: ViewedRun) -> Array:
    """Table I's e (2,) [rad^2], a mean square, of the first model's q over the judged instants; NaN where unknown."""
    measured, model = scene.subject.q, scene.models[0].q
    if measured is None or model is None:
        return np.full(2, np.nan)
    squares = (model - measured)[scene.judged] ** 2
    return np.nanmean(squares, axis=0) if np.isfinite(squares).any() else np.full(2, np.nan)


def extremes_figure(scenes: Sequence[ViewedRun]) -> Figure:
    """q1 and q2 [rad] of the recording with the largest e (left) and with the smallest (right); e in the title."""
    with house_style():
        ordered = sorted(scenes, key=lambda scene: -np.nan_to_num(mean_square_error(scene).sum(), nan=-1.0))
        shown = [("worst", ordered[0]), ("best", ordered[-1])] if len(ordered) > 1 else [("only", ordered[0])]
        figure = new_figure(3.4)
        panels = figure.subplots(2, len(shown), squeeze=False)
        for column, (which, scene) in enumerate(shown):
            error = mean_square_error(scene)
            panels[0, column].set_title(f"{which}: {scene.name}\ne = [{error[0]:.2g}, {error[1]:.2g}] rad$^2$")
            for index in range(2):
                axes = panels[index, column]
                for party in (scene.subject, *scene.models[:1]):
                    if party.q is not None:
                        draw_line(axes, party.role, scene.t, party.q[:, index])
                axes.set_ylabel(f"q{index + 1} [rad]")
            panels[1, column].set_xlabel("t [s]")
        legend_above(figure, panels[0, 0])
        return figure
