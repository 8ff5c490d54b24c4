"""The arm with other values of its declared numbers: sections, masses and quadrature are made anew."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

from affine_model.arm import Arm
from tentacle.declared import with_values
from tentacle.recording import Declaration

DeclaredValues = tuple[tuple[str, float], ...]  # fields as in recording.toml, with their values


@lru_cache(maxsize=256)
def arm_at(arm: Arm, values: DeclaredValues) -> Arm:
    """The arm with these declared values."""
    if not values:
        return arm
    found = with_values(Declaration(arm.specimen, arm.fluid, arm.gravity), dict(values))
    return replace(arm, specimen=found.specimen, fluid=found.fluid, gravity=found.gravity)
