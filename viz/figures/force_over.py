"""The missing force over each coordinate of the place where it acts."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.figure import Figure

from tentacle.proposed_law import ForceOver
from viz.figures.style import house_style, new_figure
from viz.palette import AUGMENTED, NEUTRAL

COLUMNS = 3


def force_over_figure(found: Sequence[ForceOver]) -> Figure:
    """Small multiples, the coordinate that predicts most first: mean force in bins of equal count, with a band of one
    standard deviation; the title has the share of its variance that the curve predicts on other stretches.
    """
    with house_style():
        rows = -(-len(found) // COLUMNS)
        figure = new_figure(1.7 * rows)
        axes = figure.subplots(rows, COLUMNS, sharey=True, squeeze=False)
        for axis, one in zip(axes.ravel(), found, strict=False):
            force, band = 1e3 * one.force, 1e3 * one.deviation
            axis.fill_between(one.value, force - band, force + band, color=AUGMENTED.hex, alpha=0.3, linewidth=0.0)
            axis.plot(one.value, force, color=AUGMENTED.hex, marker=".", markersize=3.0)
            axis.axhline(0.0, color=NEUTRAL.hex, linewidth=0.6)
            axis.set_title(f"predicts {100.0 * one.predicted:.0f} %" if one.predicted >= 0.005 else "predicts nothing")
            axis.locator_params(axis="x", nbins=4)
            axis.set_xlabel(f"{one.coordinate.split(',')[0]} [{one.unit}]")
            if axis in axes[:, 0]:
                axis.set_ylabel("force [mN]")
        for axis in axes.ravel()[len(found) :]:
            axis.set_axis_off()
        return figure
