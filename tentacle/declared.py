"""Uncertain numbers of a declaration: a number with a standard deviation, or a range.

    value ~ N(value, sd^2)   or   value ~ U(low, high),   cut at what is physically possible

A field is named as in recording.toml, with its table: specimen.density_kg_m3, gravity.angle_rad, markers.tip.s.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING

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
    "clamp_length_m": "clamp_length",
    "shear_compliance": "shear_compliance",
}
NORMAL_REACH = 6.0  # standard deviations within which a normal number is searched (2e-9 of its probability lies beyond)


@dataclass(frozen=True)
class Uncertain:
    """One declared number that is not known exactly.

    field: its dotted name; value: the mean, or the middle of the range; sd: the standard deviation, None for a range;
    low, high: the range, or the physical limits of a normal number. only_in: the one recording with this statement
    (empty: all recordings of the arm share it).
    """

    field: str
    value: float
    sd: float | None
    low: float = -math.inf
    high: float = math.inf
    only_in: str = ""

    @property
    def name(self) -> str:
        """Its field, and the recording where it belongs to one alone."""
        return f"{self.field} of {self.only_in}" if self.only_in else self.field

    @property
    def spread(self) -> float:
        """Standard deviation of what was declared, also of a range (its width over sqrt(12))."""
        return (self.high - self.low) / math.sqrt(12.0) if self.sd is None else self.sd

    @property
    def bounds(self) -> tuple[float, float]:
        """Limits of the number: the range, or REACH standard deviations within the physical limits."""
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


def value_in(declaration: Declaration, field: str) -> float | None:
    """The value of a field of specimen, fluid or gravity in a declaration; None where it has no such field."""
    table, _, name = field.partition(".")
    if table == "specimen":
        attribute, specimen = SPECIMEN_FIELDS[name], declaration.specimen
        section_has = attribute in {one.name for one in fields(specimen.section)}
        found = getattr(specimen.section if section_has else specimen, attribute, None)
        return None if found is None else float(found)
    if table == "fluid":
        return declaration.fluid.density
    return declaration.gravity.angle if table == "gravity" else None
