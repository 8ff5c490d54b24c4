"""An effect over the recordings of a library: each recording's own estimate, and in which of them it acts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any

import numpy as np
from matplotlib.dates import AutoDateLocator, ConciseDateFormatter, date2num
from matplotlib.figure import Figure

from viz.figures.style import house_style, new_figure
from viz.palette import NEUTRAL
from viz.words import effect_name

ACTS_COLOUR = "#D55E00"  # Okabe and Ito
PANEL_HEIGHT = 2.3


@dataclass(frozen=True)
class PresencePanel:
    """title, label of the strength with its unit; a date, an estimate, its standard deviation and whether the effect is
    claimed there, for each recording that shows it.
    """

    title: str
    label: str
    dates: Sequence[datetime]
    values: Sequence[float]
    deviations: Sequence[float]
    claimed: Sequence[bool]


def presence_panel(
    arm: Mapping[str, Any], effect: Mapping[str, Any], rows: Mapping[str, Mapping[str, Any]]
) -> PresencePanel:
    """The panel of an effect in the plain data of tentacle library joint; rows: SHA-256 -> row of the table."""
    claimed, shown = set(effect["claimed"]), effect["shown_as"]
    known = [
        (rows[content]["date"], value, deviation, content in claimed)
        for content, value, deviation in zip(arm["recordings"], effect["estimates"], effect["deviations"], strict=True)
        if value is not None and content in rows
    ]
    columns = list(zip(*known, strict=True)) or [(), (), (), ()]
    title = f"{' / '.join(map(effect_name, effect['names']))}, arm {arm['specimen']}"
    return PresencePanel(title, f"{shown['parameter']} [{shown['unit']}]", *columns)


def presence_figure(panels: Sequence[PresencePanel]) -> Figure | None:
    """A panel for every effect that was found; None where there is none."""
    if not panels:
        return None
    with house_style():
        figure = new_figure(PANEL_HEIGHT * len(panels) + 0.3)
        drawn = figure.subplots(len(panels), 1, squeeze=False)[:, 0]
        for axes, panel in zip(drawn, panels, strict=True):
            dates, claimed = np.array(date2num(list(panel.dates))), np.array(panel.claimed, dtype=bool)
            for which, colour, label in ((~claimed, NEUTRAL.hex, "does not act"), (claimed, ACTS_COLOUR, "acts")):
                axes.errorbar(
                    dates[which], np.array(panel.values)[which], yerr=1.96 * np.array(panel.deviations)[which],
                    fmt="o", color=colour, markersize=3, elinewidth=0.7, label=label,
                )  # fmt: skip
            axes.axhline(0.0, color=NEUTRAL.hex, linewidth=0.6)
            axes.set_title(panel.title)
            axes.set_ylabel(panel.label)
            locator = AutoDateLocator(minticks=3, maxticks=7, interval_multiples=False)
            axes.xaxis.set_major_locator(locator)
            axes.xaxis.set_major_formatter(ConciseDateFormatter(locator))
        handles, labels = drawn[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper right", ncols=2)
        return figure
