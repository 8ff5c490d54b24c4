"""Fitted parameters of many recordings over time, each with its interval, an arm a marker."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime

import numpy as np
from matplotlib.axes import Axes
from matplotlib.dates import AutoDateLocator, ConciseDateFormatter, date2num
from matplotlib.figure import Figure

from viz.figures.style import house_style, new_figure
from viz.palette import NEUTRAL
from viz.words import effect_name

FEWEST_POINTS = 3  # points that make a trend
COLUMNS, PANEL_HEIGHT = 2, 2.1
ARM_SYMBOLS = "os^Dv*PX"
ARM_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#AA3377", "#56B4E9", "#E69F00")  # Okabe and Ito
LEGEND = 8  # arms that a legend names; of more the table tells
POINTS_A_PANEL = 400  # points a panel: beyond them they are thinned evenly


@dataclass(frozen=True)
class TrendPoint:
    """A parameter's value in one recording, with its interval; arm: which specimen."""

    date: datetime
    arm: str
    value: float
    low: float
    high: float


def trends_figure(trends: Mapping[tuple[str, str, str], Sequence[TrendPoint]]) -> Figure | None:
    """A panel for every (effect, parameter, unit) with FEWEST points or more; None where there is none.

    An axis reaches over the middle 98 % of the values: a fit that ran away does not hide the others.
    """
    drawn = {name: points for name, points in trends.items() if len(points) >= FEWEST_POINTS}
    if not drawn:
        return None
    rows = -(-len(drawn) // COLUMNS)
    with house_style():
        figure = new_figure(PANEL_HEIGHT * rows)
        panels = np.ravel(figure.subplots(rows, COLUMNS, squeeze=False))
        arms = sorted({point.arm for points in drawn.values() for point in points})
        for axes, (name, points) in zip(panels, drawn.items(), strict=False):
            _panel(axes, name, points, arms)
        for axes in panels[len(drawn) :]:
            axes.remove()
        if len(arms) <= LEGEND:
            handles, labels = panels[0].get_legend_handles_labels()
            figure.legend(handles, labels, loc="outside upper center", ncols=4)
        return figure


def _panel(axes: Axes, name: tuple[str, str, str], points: Sequence[TrendPoint], arms: Sequence[str]) -> None:
    effect, parameter, unit = name
    kept = points[:: max(1, -(-len(points) // POINTS_A_PANEL))]
    for place, arm in enumerate(arms):
        own = [point for point in kept if point.arm == arm]
        value = np.array([point.value for point in own])
        reach = np.array([[p.value - p.low for p in own], [p.high - p.value for p in own]]).reshape(2, -1)
        axes.errorbar(
            np.array(date2num([point.date for point in own])), value, yerr=np.maximum(reach, 0.0),
            fmt=ARM_SYMBOLS[place % len(ARM_SYMBOLS)], color=ARM_COLOURS[place % len(ARM_COLOURS)], ecolor=NEUTRAL.hex,
            markersize=3, elinewidth=0.8, label=f"arm {arm}",
        )  # fmt: skip
    values = np.array([[p.low, p.high] for p in kept])
    low, high = np.percentile(values[:, 0], 1), np.percentile(values[:, 1], 99)
    margin = 0.08 * (high - low) or 0.05 * max(abs(high), 1e-12)
    axes.set_ylim(low - margin, high + margin)
    axes.set_title(f"{effect_name(effect)} {parameter}")
    axes.set_ylabel(f"{parameter} [{unit}]")
    locator = AutoDateLocator(minticks=3, maxticks=6, interval_multiples=False)
    axes.xaxis.set_major_locator(locator)
    axes.xaxis.set_major_formatter(ConciseDateFormatter(locator))
