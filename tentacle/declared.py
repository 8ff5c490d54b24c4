"""What a declaration does not know exactly: a number with a standard deviation, or a range.

    value ~ N(value, sd^2)   or   value ~ U(low, high),   cut at what is physically possible

A field is named as in recording.toml, with its table: specimen.density_kg_m3, gravity.angle_rad, markers.tip.s.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING

from tentacle.errors import InputError
from tentacle.specimen import Cone, Rectangle, Specimen

if TYPE_CHECKING:
    from tentacle.recording import Declaration

# The field of recording.toml's [specimen] -> the attribute of Specimen, Cone or Rectangle.
SPECIMEN_FIELDS = {
    "length_m": "length",
    "density_kg_m3": "density",
    "tip_mass_kg": "tip_mass",
    "tip_mass_reach_m": "tip_mass_reach",
    "tip_mass_drop_m": "tip_mass_drop",
    "tip_mass_density_kg_m3": "tip_mass_density",
    "base_radius_m": "base_radius",
    "tip_radius_m": "tip_radius",
    "width_m": "section_width",
    "height_m": "height",
}
NORMAL_REACH = 6.0  # standard deviations: beyond, a normal number is never looked for (2e-9 of its probability)


@dataclass(frozen=True)
class Uncertain:
    """One declared number that is not known exactly.

    field: its dotted name; value: the mean, or the middle of the range; sd: the standard deviation, None for a range;
    low, high: the range, or what is physically possible of a normal number.
    """

    field: str
    value: float
    sd: float | None
    low: float = -math.inf
    high: float = math.inf

    @property
    def spread(self) -> float:
        """Standard deviation of what was declared, also of a range (its width over sqrt(12))."""
        return (self.high - self.low) / math.sqrt(12.0) if self.sd is None else self.sd

    @property
    def bounds(self) -> tuple[float, float]:
        """Where the number may lie: the range, or REACH standard deviations within what is possible."""
        if self.sd is None:
            return self.low, self.high
        return max(self.low, self.value - NORMAL_REACH * self.sd), min(self.high, self.value + NORMAL_REACH * self.sd)

    def table(self) -> dict[str, float]:
        """As recording.toml writes it."""
        return {"low": self.low, "high": self.high} if self.sd is None else {"value": self.value, "sd": self.sd}


def with_values(declaration: Declaration, values: Mapping[str, float]) -> Declaration:
    """The declaration with these fields (of specimen, fluid, gravity, camera) at other values.

    Fields of markers are no part of a declaration and are left out. Raises InputError where a value is impossible.
    """
    for field, value in values.items():
        table, _, name = field.partition(".")
        if table == "specimen":
            declaration = replace(declaration, specimen=_specimen_with(declaration.specimen, name, value))
        elif table == "fluid":
            declaration = replace(declaration, fluid=replace(declaration.fluid, density=value))
        elif table == "gravity":
            declaration = replace(declaration, gravity=replace(declaration.gravity, angle=value))
        elif table == "camera" and declaration.camera is not None:
            declaration = replace(declaration, camera=replace(declaration.camera, metres_per_px=value))
    return declaration


def _specimen_with(specimen: Specimen, name: str, value: float) -> Specimen:
    attribute = SPECIMEN_FIELDS[name]
    section = specimen.section
    if attribute in {field.name for field in fields(section)}:
        changed: Cone | Rectangle = replace(section, **{attribute: value})
        return replace(specimen, section=changed)
    return replace(specimen, **{attribute: value})


def shared(declarations: list[tuple[Uncertain, ...]]) -> tuple[Uncertain, ...]:
    """The uncertain numbers of several recordings of one arm: a field that several declare is one number.

    Raises InputError where two recordings declare the same field with different uncertainty.
    """
    found: dict[str, Uncertain] = {}
    for declared in declarations:
        for number in declared:
            other = found.setdefault(number.field, number)
            if other != number:
                raise InputError(
                    f"is {number.table()} in one recording and {other.table()} in another",
                    field=number.field,
                    expected="one statement for one arm",
                )
    return tuple(found.values())
