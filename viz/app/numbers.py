"""The numbers that only the user knows. A number is missing until it is typed; no example is taken for it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from tentacle.errors import InputError


@dataclass(frozen=True)
class Asked:
    """A number that is asked for: what it is, with its unit; an example; whether it may be 0."""

    words: str
    example: str
    may_be_zero: bool = False


ASKED = {
    "length": Asked("length of the arm [m]", "0.14"),
    "base_radius": Asked("radius at the base [m]", "0.0125"),
    "tip_radius": Asked("radius at the tip [m]", "0.004", may_be_zero=True),
    "density": Asked("density of the material [kg/m3]", "1070"),
    "fluid_density": Asked("density of the fluid [kg/m3]", "998 in water, 0 in air", may_be_zero=True),
    "ruler": Asked("length of the ruler [m]", "0.05"),
}


def typed_number(name: str, text: str) -> float | None:
    """The number in a field, None where it is empty. A decimal comma is one. InputError where it cannot be used."""
    asked, bare = ASKED[name], text.strip()
    if not bare:
        return None
    expected = f"a number, for example {asked.example}"
    try:
        value = float(bare.replace(",", "."))
    except ValueError:
        raise InputError(f"{bare!r} is no number", field=asked.words, expected=expected) from None
    if not 0.0 <= value < math.inf or (value == 0.0 and not asked.may_be_zero):
        raise InputError(f"{value:g} is out of range", field=asked.words, expected=expected)
    return value


def required_numbers(typed: Mapping[str, str], names: Iterable[str]) -> dict[str, float]:
    """Every number of these names. InputError that names all that are missing."""
    found = {name: typed_number(name, typed.get(name, "")) for name in names}
    missing = [ASKED[name].words for name, value in found.items() if value is None]
    if missing:
        raise InputError("not given yet", field=", ".join(missing), expected="the numbers of your arm, in part 2")
    return {name: value for name, value in found.items() if value is not None}
