"""Tables of the page: every recording with its state, and two answers side by side."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Mapping
from typing import Any

from nicegui import ui

from tentacle.model import Estimate
from tentacle.rounding import NO_VALUE, number
from viz.app.desk import Desk


def batch_table(place: ui.column, desk: Desk, run_all: Callable[[], Awaitable[None]]) -> None:
    """Recordings and their states, and a button that diagnoses all that are declared."""
    place.clear()
    rows = [{"name": name, "state": desk.state(name)} for name in desk.recordings()]
    with place:
        columns = [{"name": key, "label": key, "field": key, "align": "left"} for key in ("name", "state")]
        ui.table(columns=columns, rows=rows, row_key="name").classes("w-full").props("wrap-cells")
        ui.button("diagnose all that have no answer", on_click=run_all).props("no-caps outline")


def compare_table(place: ui.column, desk: Desk) -> None:
    """Two answers chosen from lists, their verdicts, errors and parameters beside one another."""
    place.clear()
    names = desk.answers()
    with place:
        if len(names) < 2:
            ui.label("Two answers are needed.").classes("faint")
            return
        with ui.row():
            left = ui.select(names, value=names[0], label="one")
            right = ui.select(names, value=names[1], label="other")
        shown = ui.column().classes("w-full")

        def draw() -> None:
            shown.clear()
            with shown:
                columns = [
                    {"name": key, "label": label, "field": key, "align": "left"}
                    for key, label in (("what", ""), ("one", left.value), ("other", right.value))
                ]
                rows = compared(desk.verdict(left.value), desk.verdict(right.value))
                ui.table(columns=columns, rows=rows, row_key="what").classes("w-full").props("wrap-cells")

        left.on_value_change(draw)
        right.on_value_change(draw)
        draw()


def compared(one: Mapping[str, Any], other: Mapping[str, Any]) -> list[dict[str, str]]:
    """Rows (what, one, other) of two verdicts; a parameter that only one has is told as such."""
    columns = [_told(answer) for answer in (one, other)]
    keys = list(dict.fromkeys([*columns[0], *columns[1]]))
    return [{"what": key, "one": columns[0].get(key, NO_VALUE), "other": columns[1].get(key, NO_VALUE)} for key in keys]


def _told(answer: Mapping[str, Any]) -> dict[str, str]:
    told = {
        "verdict": answer["verdict"].replace("_", " "),
        "effects": ", ".join(answer["effects"]) or NO_VALUE,
        "confidence": f"{answer['confidence']:.0%}",
    }
    for which in ("before", "after", "floor"):
        told[f"error {which} [mm]"] = number(answer["error"][which]["midline_mm"])
    for effect, values in answer["parameters"].items():
        for name, one in values.items():
            estimate = Estimate(one["value"], one["low"], one["high"], one["unit"])
            told[f"{effect}.{name} [{one['unit']}]"] = f"{estimate.value_words} ({estimate.interval_words})"
    return told
