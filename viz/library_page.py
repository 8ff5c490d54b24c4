"""The page of a library: one table to filter and sort, parameters over time, a residual map a recording."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from tentacle.rounding import number
from tentacle.signals import Array
from viz.figures.presence import presence_figure, presence_panel
from viz.figures.residual_maps import residual_maps_figure
from viz.figures.trends import POINTS_A_PANEL, TrendPoint, trends_figure
from viz.joint_words import arm_title, joint_sentences
from viz.report import render_page

LIST_HEADER = (
    "recording", "date", "arm", "length [mm]", "seen as", "seconds", "state", "verdict", "effects", "confidence",
    "before [mm]", "after [mm]", "floor [mm]", "joint",
)  # fmt: skip
NUMERIC = (3, 5, 9, 10, 11, 12)
MAPS = 48  # of the recordings whose models leave most over the noise


@dataclass(frozen=True)
class LibraryRow:
    """One recording: its cells, the folder of its layer ("" where there is none), and whether it failed."""

    cells: tuple[str, ...]
    layer: str
    warned: bool


@dataclass(frozen=True)
class LibraryPage:
    """What the template shows."""

    title: str
    headline: str
    counts: Sequence[tuple[str, str]]
    header: tuple[str, ...]
    numeric: tuple[int, ...]
    rows: Sequence[LibraryRow]
    pictures: Sequence[tuple[str, str, Figure]]
    together: Sequence[str] = ()


def library_page(
    name: str,
    rows: Sequence[Mapping[str, Any]],
    parameters: Sequence[Mapping[str, Any]],
    maps: Mapping[str, Array],
    joint: Sequence[Mapping[str, Any]] = (),
) -> str:
    """The page as HTML text.

    rows: of Library.table; parameters: of Library.parameters; maps: layer key -> residual (places, times) [mm], of
    those that are to be shown; joint: each arm's joint answer, as tentacle library joint writes it.
    """
    states = Counter(row["state"] for row in rows)
    verdicts = Counter(row["verdict"].replace("_", " ") for row in rows if row["verdict"])
    arms = len({row["specimen"] for row in rows if row["specimen"]})
    headline = f"{len(rows)} recording{'s' * (len(rows) != 1)} of {arms} arm{'s' * (arms != 1)}; " + (
        ", ".join(f"{count} {verdict}" for verdict, count in verdicts.most_common()) or "none is diagnosed yet"
    )
    by_content = {row["sha256"]: row for row in rows}
    page = LibraryPage(
        name, headline + ".", [(state, str(count)) for state, count in states.most_common()], LIST_HEADER, NUMERIC,
        [_row(row) for row in rows], [*_joint_pictures(joint, by_content), *_pictures(rows, parameters, maps)],
        [f"{arm_title(arm)} {sentence}" for arm in joint for sentence in joint_sentences(arm, by_content)],
    )  # fmt: skip
    return render_page("library.html", page=page)


def worst(rows: Sequence[Mapping[str, Any]], count: int = MAPS) -> list[Mapping[str, Any]]:
    """The diagnosed recordings whose model leaves most over its floor, worst first."""
    found = [row for row in rows if row["key"] is not None and row["after_mm"] is not None]
    return sorted(found, key=lambda row: -row["after_mm"] / max(row["floor_mm"] or 0.0, 1e-6))[:count]


def _row(row: Mapping[str, Any]) -> LibraryRow:
    date = "-" if row["date"] is None else f"{row['date']:%Y-%m-%d %H:%M}"
    cells = (
        row["name"], date, row["specimen"] or "-", number(row["length_mm"]), row["seen_as"] or "-",
        number(row["seconds"]), row["state"], (row["verdict"] or "-").replace("_", " "), row["effects"] or "",
        number(row["confidence"]), number(row["before_mm"]), number(row["after_mm"]), number(row["floor_mm"]),
        "-" if row["joint"] is None else row["joint"],
    )  # fmt: skip
    whole = row["key"] is not None and row["failed"] is None
    return LibraryRow(cells, f"layers/{row['key']}" if whole else "", row["state"] in ("failed", "unreadable"))


def _joint_pictures(
    joint: Sequence[Mapping[str, Any]], rows: Mapping[str, Mapping[str, Any]]
) -> list[tuple[str, str, Figure]]:
    panels = [presence_panel(arm, effect, rows) for arm in joint for effect in arm["effects"]]
    figure = presence_figure(panels)
    words = "Each recording's own estimate of the effect's strength with its 95 % interval, and where the effect acts."
    return [] if figure is None else [("Effects over the library", words, figure)]


def _pictures(
    rows: Sequence[Mapping[str, Any]], parameters: Sequence[Mapping[str, Any]], maps: Mapping[str, Array]
) -> list[tuple[str, str, Figure]]:
    known = {row["key"]: row for row in rows if row["key"] is not None}
    trends: dict[tuple[str, str, str], list[TrendPoint]] = {}
    for one in parameters:
        row = known.get(one["key"])
        if row is None or not np.isfinite([one["value"], one["low"], one["high"]]).all():
            continue
        point = TrendPoint(row["date"], row["specimen"], one["value"], one["low"], one["high"])
        trends.setdefault((one["effect"], one["parameter"], one["unit"]), []).append(point)
    pictures = []
    figure = trends_figure({name: sorted(points, key=lambda p: p.date) for name, points in trends.items()})
    if figure is not None:
        pictures.append(
            (
                "Parameters over time",
                f"Fitted values with their 95 % intervals, {POINTS_A_PANEL} points per panel at most.",
                figure,
            )
        )
    chosen = [(row["name"], maps[row["key"]]) for row in worst(rows) if row["key"] in maps]
    figure = residual_maps_figure(chosen)
    if figure is not None:
        words = (
            f"Distance of the augmented model to the measured points, time to the right, base below; the {len(chosen)} "
            "recordings with the largest residual over the noise, worst first."
        )
        pictures.append(("Residuals", words, figure))
    return pictures
