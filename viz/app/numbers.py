"""The numbers that only the user knows. A number is missing until it is typed; no example is taken for it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from tentacle.errors import InputError
from tentacle.io.parsed_number import parsed_number


@dataclass(frozen=True)
class AskedNumber:
    """A number that is asked for: what it is, with its unit, and an example."""

    words: str
    example: str


ASKED = {
    "length": AskedNumber("length of the arm [m]", "0.14"),
    "base_radius": AskedNumber("radius at the base [m]", "0.0125"),
    "tip_radius": AskedNumber("radius at the tip [m]", "0.004"),
    "density": AskedNumber("density of the material [kg/m3]", "1070"),
    "fluid_density": AskedNumber("density of the fluid [kg/m3]", "998 in water, 0 in air"),
    "ruler": AskedNumber("length of the ruler [m]", "0.05"),
}


def typed_number(name: str, text: str) -> float | None:
    """The number in a field, None where it is empty. A decimal comma is one. InputError where it cannot be used."""
    asked, bare = ASKED[name], text.strip()
    if not bare:
        return None
    return parsed_number(name, bare, asked.words, f"a number, for example {asked.example}")


def required_numbers(typed: Mapping[str, str], names: Iterable[str]) -> dict[str, float]:
    """Every number of these names. InputError that names all that are missing."""
    found = {name: typed_number(name, typed.get(name, "")) for name in names}
    missing = [ASKED[name].words for name, value in found.items() if value is None]
    if missing:
        raise InputError("not given yet", field=", ".join(missing), expected="the numbers of your arm, in part 2")
    return {name: value for name, value in found.items() if value is not None}
