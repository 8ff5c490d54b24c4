"""The laws of its own that an arm's declaration names: effects of the catalogue that act in it with unknown strength.

A fit treats their parameters as it treats E and eta: in all recordings of the arm, the baseline's too.
"""

from __future__ import annotations

from difflib import get_close_matches
from itertools import product

from affine_model.effect import Effect
from affine_model.effects import absent_effects, catalogue
from tentacle.errors import InputError
from tentacle.specimen import Fluid, Specimen, declared_effects

OF_AN_ARM = ("fluid", "weight", "elastic")  # families that act in an arm, not in its servo or its camera
SIZES = (0.5, 2.0, 6.0, 20.0)  # of a strength, in nominal sizes: where a fit may start


def declared_laws(specimen: Specimen, fluid: Fluid) -> tuple[Effect, ...]:
    """The laws that the specimen declares and that act in this fluid.

    A law of the fluid does not act in air. Added mass that [fluid] declares is no law of the arm.
    """
    found = (catalogue()[name] for name in specimen.laws if name not in declared_effects(specimen, fluid))
    return tuple(law for law in found if law.family != "fluid" or fluid.density > 0.0)


def refuse_unknown_laws(specimen: Specimen, file: str) -> None:
    """InputError if the specimen declares a law that the catalogue lacks, or that does not act in an arm."""
    known = sorted(effect.name for effect in absent_effects() if effect.family in OF_AN_ARM)
    for name in specimen.laws:
        if name not in known:
            close = get_close_matches(name, known, n=1)
            hint = f" (did you mean {close[0]}?)" if close else ""
            expected = f"laws that act in an arm: {', '.join(known)}"
            raise InputError(f"{name!r} is not known{hint}", file=file, field="specimen.laws", expected=expected)


def law_starts(law: Effect) -> list[tuple[float, ...]]:
    """Values of a law's parameters where a fit may start: every shape that a search tries, with strengths of several
    sizes.
    """
    starts = []
    for shapes in product(*(parameter.scan for parameter in law.shapes)):
        shape = dict(zip((parameter.name for parameter in law.shapes), shapes, strict=True))
        for size in (*SIZES, *(-size for size in SIZES if law.strengths[0].bounds[0] < 0.0)):
            values = {p.name: min(max(size * p.nominal, p.bounds[0]), p.bounds[1]) for p in law.strengths} | shape
            starts.append(tuple(values[parameter.name] for parameter in law.parameters))
    return starts
