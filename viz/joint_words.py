"""What a library's recordings say together, in sentences: of the plain data that tentacle library joint writes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Any

from tentacle.rounding import number, rounded
from viz.words import effect_name

SPANS = 4  # runs of recordings that a sentence names


def joint_sentences(arm: Mapping[str, Any], rows: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """The arm's answer; rows: SHA-256 -> row of the library's table."""
    known = [content for content in arm["recordings"] if content in rows]
    words = [_effect_words(one, arm["recordings"], rows) for one in arm["effects"]]
    words += [_change_words(one, [rows[content]["date"] for content in known]) for one in _changed(arm)]
    if not arm["effects"]:
        words.insert(0, f"No absent effect acts in these {len(arm['recordings'])} recordings, as far as they show.")
    if not _changed(arm):
        words.append("No parameter of the arm changes with time, as far as they show.")
    return words


def arm_title(arm: Mapping[str, Any]) -> str:
    """Which arm, of how many recordings."""
    return f"arm {arm['specimen']}, {len(arm['recordings'])} recordings together:"


def _changed(arm: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    return [one for one in arm["parameters"] if one["changed"]]


def _effect_words(one: Mapping[str, Any], contents: Sequence[str], rows: Mapping[str, Mapping[str, Any]]) -> str:
    where = spans([content in set(one["claimed"]) for content in contents])
    named = [f"{_name(contents[a], rows)} to {_name(contents[b], rows)}" if a != b else _name(contents[a], rows)
             for a, b in where[:SPANS]]  # fmt: skip
    more = f" and {len(where) - SPANS} runs more" if len(where) > SPANS else ""
    names = [effect_name(name) for name in one["names"]]
    what = names[0] if len(names) == 1 else f"One of {', '.join(names)}"
    strengths = ", ".join(
        f"{s['parameter']} {rounded(s['value'], s['high'] - s['low'])}"
        f" [{rounded(s['low'], s['high'] - s['low'])}, {rounded(s['high'], s['high'] - s['low'])}] {s['unit']}"
        for s in one["strengths"]
    )
    if not where:
        return f"{what} acts in some of {len(contents)} recordings; they do not show in which. {strengths}."
    count, place = len(one["claimed"]), ", ".join(named) + more
    before = "; in none before" if len(where) == 1 and where[0][0] > 0 else ""
    after = ", in none after" if before and where[0][1] < len(contents) - 1 else ""
    of = strengths if len(names) == 1 else f"as {names[0]}: {strengths}"
    return f"{what} acts in {count} of {len(contents)} recordings: {place}{before}{after}. {of}."


def _name(content: str, rows: Mapping[str, Mapping[str, Any]]) -> str:
    return str(rows[content]["name"]) if content in rows else content[:8]


def spans(flags: Sequence[bool]) -> list[tuple[int, int]]:
    """First and last place of each run of True."""
    found: list[tuple[int, int]] = []
    for place, flag in enumerate(flags):
        if flag and found and found[-1][1] == place - 1:
            found[-1] = (found[-1][0], place)
        elif flag:
            found.append((place, place))
    return found


def _change_words(one: Mapping[str, Any], dates: Sequence[datetime]) -> str:
    change, low, high = (100.0 * value / abs(one["start"]) for value in one["change"])
    way = "rose" if change > 0.0 else "fell"
    if change < 0.0:
        change, low, high = -change, -high, -low
    width = high - low
    since = f" from {min(dates):%Y-%m-%d} to {max(dates):%Y-%m-%d}" if dates else ""
    return (
        f"{effect_name(one['effect'])} {one['parameter']} {way} by {rounded(change, width)} % "
        f"[{rounded(low, width)}, {rounded(high, width)}]{since}; it was {number(one['start'])} {one['unit']}."
    )
