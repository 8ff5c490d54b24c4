"""Verdicts and effects as short texts, the same in the report and the session."""

from __future__ import annotations

import re
from collections.abc import Sequence

from tentacle.diagnosis import Diagnosis, ErrorMeasure, RankedEffect, Verdict
from tentacle.rounding import NO_VALUE, number

VERDICT_TITLES: dict[Verdict, str] = {
    "nothing_missing": "Nothing is missing",
    "effect": "An effect is missing",
    "group": "One of a group is missing",
    "unknown": "Something unknown is missing",
}

CANNOT_TELL = "These data cannot tell"
MORE_COORDINATES = "No effect is missing; the arm needs more curvature coordinates"

MEASURES = (
    ("midline_mm", "midline", "mm"),
    ("angle_rad", "angle along the arm", "rad"),
    ("q1", "q1", "rad"),
    ("q2", "q2", "rad"),
    ("thrust_n", "thrust", "N"),
)


def verdict_title(diagnosis: Diagnosis) -> str:
    """The verdict as a title; too few data, and an arm that only needs more coordinates, have titles of their own."""
    if diagnosis.cannot_tell:
        return CANNOT_TELL
    if diagnosis.verdict == "effect" and not diagnosis.missing_effects:
        return MORE_COORDINATES
    return VERDICT_TITLES[diagnosis.verdict]


def probability_words(probability: float) -> str:
    """A probability in per cent; a value that would round to 0 or 100 % is stated as a bound."""
    if probability != probability:
        return NO_VALUE
    if probability > 0.999:
        return "> 99.9 %"
    return "< 0.1 %" if probability < 0.001 else f"{100.0 * probability:.1f} %"


def listed(names: Sequence[str], last: str = "and") -> str:
    """Names as a list in a sentence: a, b and c."""
    if len(names) < 2:
        return "".join(names)
    return f"{', '.join(names[:-1])} {last} {names[-1]}"


def error_rows(before: ErrorMeasure, after: ErrorMeasure, floor: ErrorMeasure) -> list[tuple[str, str, str, str, str]]:
    """Rows (quantity, unit, before, after, floor) of what was measured."""
    rows = []
    for field, name, unit in MEASURES:
        values = [getattr(measure, field) for measure in (before, after, floor)]
        if any(value is not None for value in values):
            rows.append((name, unit, *(number(value) for value in values)))
    return rows


def effect_name(effect: str) -> str:
    """An effect's contract name as words."""
    return effect.replace("_", " ")


def in_words(sentence: str, diagnosis: Diagnosis) -> str:
    """The sentence with the titles of effects and laws instead of their names; names of files stay."""
    names = {one.law.name: one.law.title for one in diagnosis.missing.laws}
    for effect in (*diagnosis.effects, *(ranked.effect for ranked in diagnosis.ranking)):
        names[effect] = effect_name(effect)
    any_name = "|".join(sorted(map(re.escape, names), key=len, reverse=True))
    return re.sub(rf"(?<![\w/.])({any_name})(?![\w/]|\.\w)", lambda one: names[one[1]], sentence) if names else sentence


def in_ranking(diagnosis: Diagnosis) -> list[RankedEffect]:
    """The candidates, the likeliest first. After an unknown the one of the highest score is first, for the candidates
    have no probability then: the effects only resemble what acts.
    """
    ranked = list(diagnosis.ranking)
    return sorted(ranked, key=lambda one: -one.score) if diagnosis.verdict == "unknown" else ranked


def ranked_columns(diagnosis: Diagnosis) -> int:
    """The number of columns of the candidates: effect, score, error, and the probability where it has a meaning."""
    return 3 if diagnosis.verdict == "unknown" else 4
