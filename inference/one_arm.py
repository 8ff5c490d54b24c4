"""Recordings of one arm: what they share, and in what each has its own declared geometry.

Shared are the material's parameters and the effects. Each recording keeps the length, section, clamp, payload and fluid
that it declares, and its markers' places. What one arm cannot be is refused:

- another kind of section, stiffness law or treatment of the added mass, other laws of its own: these are other
  parameters;
- lengths that differ by more than the latent force's correlation length: an effect that acts at a share of the length
  would act at another place of the arm;
- thickness, width or density that differ by more than SAME: callipers on soft silicone are off by some per cent. They
  are compared at equal distances from the tip, for an arm clamped elsewhere, or from the clamp, for one that was cut.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from inference.latent_force import CORRELATION_LENGTH
from inference.prepare import RELEASE, Prepared
from tentacle.declared import SPECIMEN_FIELDS, Uncertain, value_in
from tentacle.errors import InputError
from tentacle.recording import Declaration, Recording
from tentacle.specimen import Rectangle, Specimen

SAME = 0.1  # relative: two measurements of one section or one density
FIELDS = (*(f"specimen.{name}" for name in SPECIMEN_FIELDS), "fluid.density_kg_m3", "gravity.angle_rad")
PLACES = np.linspace(0.0, 1.0, 5)  # of the shorter arm, where sections are compared


def same_arm(recordings: Sequence[Recording]) -> None:
    """InputError where a recording declares an arm that the first one's cannot be, naming both values."""
    first = recordings[0]
    for other in recordings[1:]:
        differing = _difference(first.declaration, other.declaration)
        if differing is not None:
            field, values, expected = differing
            raise InputError(
                f"is {values[1]} here and {values[0]} in {first.name}",
                file=f"{other.name}/recording.toml",
                field=field,
                expected=f"recordings of one arm: {expected}",
            )


def _difference(first: Declaration, other: Declaration) -> tuple[str, tuple[object, object], str] | None:
    """The field in which no arm can be both, its two values, and what is expected."""
    one, two = first.specimen, other.specimen
    kinds = type(one.section).__name__.lower(), type(two.section).__name__.lower()
    named = (
        ("specimen.section", kinds),
        ("specimen.stiffness", (one.stiffness, two.stiffness)),
        ("specimen.laws", (list(one.laws), list(two.laws))),
        ("fluid.added_mass", (first.fluid.added_mass, other.fluid.added_mass)),
        ("gravity.magnitude_m_s2", (first.gravity.magnitude, other.gravity.magnitude)),
    )
    for field, values in named:
        if values[0] != values[1]:
            return field, values, "the same in all"
    lengths = (one.length, two.length)
    if one.stiffness == "affine" and lengths[0] != lengths[1]:
        return "specimen.length_m", lengths, 'one length, as k0 + k1 s belongs to it (or stiffness = "section")'
    if _apart(*lengths) > CORRELATION_LENGTH:
        return "specimen.length_m", lengths, f"lengths within {100 * CORRELATION_LENGTH:.0f} %"
    if _apart(one.density, two.density) > SAME:
        return (
            "specimen.density_kg_m3",
            (f"{one.density:g}", f"{two.density:g}"),
            f"densities within {100 * SAME:.0f} %",
        )
    worst = min((_sections(one, two, end) for end in ("tip", "clamp")), key=lambda found: found.apart)
    return (worst.field, worst.values, worst.expected) if worst.apart > SAME else None


def own_geometry_words(prepared: Sequence[Prepared]) -> list[str]:
    """A sentence where recordings declare different numbers: which, and whose arm a model that is written has."""
    fields = sorted({field for p in prepared for field, _ in p.experiment.differs})
    if not fields:
        return []
    first = prepared[0].recording.name
    return [f"Each recording keeps its own {', '.join(fields)}. The model that is written has those of {first}."]


def _apart(one: float, two: float) -> float:
    return abs(one - two) / max(abs(one), abs(two))


@dataclass(frozen=True)
class SectionsApart:
    """Where two arms' sections differ most: the field, its two values, what is expected, and by how much (relative)."""

    field: str
    values: tuple[str, str]
    expected: str
    apart: float


def _sections(one: Specimen, two: Specimen, end: str) -> SectionsApart:
    """The two arms, both of one kind of section, at equal distances from that end. Thickness is compared over the
    largest thickness, and width over the largest width: a pointed tip is measured to no per cent.
    """
    along = PLACES * min(one.length, two.length)
    sizes = []
    for arm in (one, two):
        s = 1.0 - along / arm.length if end == "tip" else along / arm.length
        sizes.append(np.stack([2.0 * arm.section.half_thickness(s), arm.section.width(s)]))
    share = np.abs(sizes[0] - sizes[1]) / np.maximum(*sizes).max(axis=1, keepdims=True)
    which, place = np.unravel_index(int(np.argmax(share)), share.shape)
    first, second = (float(size[which, place]) for size in sizes)
    name, apart = ("thicknesses", "widths")[int(which)], float(share[which, place])
    expected = f"{name} within {100 * SAME:.0f} %"
    if isinstance(one.section, Rectangle):
        field = ("specimen.height_m", "specimen.width_m")[int(which)]
        return SectionsApart(field, (f"{first:g}", f"{second:g}"), expected, apart)
    values = f"{1e3 * first:.4g} mm", f"{1e3 * second:.4g} mm"
    expected += f" at one distance from the {end} (these are twice the radius, {1e3 * along[place]:.3g} mm from it)"
    return SectionsApart("specimen.base_radius_m, tip_radius_m", values, expected, apart)


def one_arm(prepared: Sequence[Prepared]) -> tuple[Declaration, list[Prepared]]:
    """The declaration that a fit starts from, the first recording's with the uncertain numbers of all; and the
    recordings, each with the fields in which it differs from the first.

    A number that all recordings state alike is one number. Else each recording that states it has its own.
    """
    declarations = [p.recording.declaration for p in prepared]
    stated = [{number.field: number for number in d.uncertain if number.field != RELEASE} for d in declarations]
    numbers: dict[str, Uncertain] = {}
    own = set[str]()
    for p, numbers_here in zip(prepared, stated, strict=True):
        for field, number in numbers_here.items():
            alike = all(other.get(field) == number for other in stated)
            own |= set() if alike else {field}
            kept = number if alike else replace(number, only_in=p.recording.name)
            known = numbers.setdefault(kept.name, kept)
            if known != kept:
                raise InputError(
                    f"is {known.table()} in one and {kept.table()} in the other",
                    file=f"{p.recording.name}/recording.toml",
                    field=field,
                    expected="another name for one of the two recordings of this name",
                )
    found = []
    for p, declaration in zip(prepared, declarations, strict=True):
        values = {field: (value_in(declarations[0], field), value_in(declaration, field)) for field in FIELDS}
        differs = [
            (field, there)
            for field, (first, there) in values.items()
            if there is not None and (there != first or field in own)
        ]
        found.append(replace(p, experiment=replace(p.experiment, differs=tuple(differs))))
    return replace(declarations[0], uncertain=tuple(numbers.values())), found
