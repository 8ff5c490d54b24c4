"""Numbers as short texts, the same in reports, sessions, notebooks and on the terminal."""

from __future__ import annotations

import math

NO_VALUE = "-"


def number(value: float | None) -> str:
    """Three significant digits, no exponent where it can be avoided; NO_VALUE where there is none."""
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
