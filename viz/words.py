"""Numbers and verdicts as short texts, the same in the report, the session and a notebook."""

from __future__ import annotations

import math
from collections.abc import Sequence

from tentacle.diagnosis import ErrorMeasure, Verdict
from tentacle.model import Estimate

VERDICT_TITLES: dict[Verdict, str] = {
    "nothing_missing": "Nothing is missing",
    "effect": "An effect is missing",
    "group": "One of a group is missing",
    "unknown": "Something unknown is missing",
}

NO_VALUE = "-"

MEASURES = (
    ("midline_mm", "midline", "mm"),
    ("angle_rad", "angle along the arm", "rad"),
    ("q1", "q1", "rad"),
    ("q2", "q2", "rad"),
    ("thrust_n", "thrust", "N"),
)


def number(value: float | None) -> str:
    """Three significant digits, no exponent where it can be avoided; NONE where there is none."""
    if value is None or value != value:  # NaN differs from itself
        return NO_VALUE
    if value != 0 and not 1e-3 <= abs(value) < 1e7:
        return f"{value:.2e}"
    if abs(value) < 1000:
        return f"{value:.3g}"
    digits = 2 - math.floor(math.log10(abs(value)))
    return f"{round(value, digits):.0f}"


def rounded(value: float, width: float) -> str:
    """The value with as many digits as an interval of that width needs: two digits of the width itself."""
    if not 0.0 < width < math.inf or not math.isfinite(value):
        return number(value)
    decimals = 1 - math.floor(math.log10(width))
    if decimals > 7 or abs(value) >= 1e7:
        digits = max(2, 2 + math.floor(math.log10(max(abs(value), width))) - math.floor(math.log10(width)))
        return f"{value:.{digits - 1}e}"
    return f"{round(value, decimals):.{max(decimals, 0)}f}"


def value_of(estimate: Estimate) -> str:
    """The value, with the digits that its interval needs."""
    return rounded(estimate.value, estimate.high - estimate.low)


def value_with_unit(estimate: Estimate) -> str:
    """The value with its unit; a number without one has none."""
    return value_of(estimate) if estimate.unit == "1" else f"{value_of(estimate)} {estimate.unit}"


def interval(estimate: Estimate) -> str:
    """The 95 % interval, or "given" where the value was not fitted."""
    if estimate.low == estimate.high:
        return "given"
    width = estimate.high - estimate.low
    return f"{rounded(estimate.low, width)} to {rounded(estimate.high, width)}"


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
