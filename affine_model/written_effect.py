"""A written law (tentacle.law) as an effect of the catalogue: the same object that a file of effects/ holds."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from affine_model.effect import Effect, Law, PairLaw, Parameter
from affine_model.laws import cos, exp, sin, sqrt, tanh
from tentacle.law.quantities import ACTS
from tentacle.law.written_law import WrittenLaw, functions_from

EFFECT_FUNCTIONS = functions_from(sqrt, exp, sin, cos, tanh)


def effect_of(law: WrittenLaw) -> Effect:
    """The effect that a written law describes."""
    parameters = tuple(Parameter(p.name, p.unit, p.nominal, p.bounds, p.words, p.scan) for p in law.parameters)
    return Effect(
        name=law.name,
        title=law.title,
        parameters=parameters,
        source=law.source,
        family="elastic" if law.acts == "moment" else "fluid",
        dissipative=law.dissipative,
        levels_off=law.levels_off,
        force=_pair(law) if law.acts == "line" else None,
        tip_force=_pair(law) if law.acts == "tip" else None,
        bending_moment=(lambda x, p: _values(law, x, p)["moment"]) if law.acts == "moment" else None,
        relaxation_time=_relaxation(law),
    )


def _relaxation(law: WrittenLaw) -> Law | None:
    if law.relaxation is None:
        return None

    def relaxation_time(_: Any, p: Any) -> Any:
        return law.relaxation_time(vars(p), EFFECT_FUNCTIONS)

    return relaxation_time


def _values(law: WrittenLaw, x: Any, p: Any) -> Mapping[str, Any]:
    seen = {name: getattr(x, name) for name in ACTS[law.acts][0] if hasattr(x, name)}
    return law.values(seen, vars(p), EFFECT_FUNCTIONS)


def _pair(law: WrittenLaw) -> PairLaw:
    """Normal and tangential force; those along x and y turned by the tangent's angle."""

    def pair(x: Any, p: Any) -> tuple[Any, Any]:
        found = _values(law, x, p)
        normal, tangential = found.get("force_n", 0.0), found.get("force_t", 0.0)
        if "force_x" in found or "force_y" in found:
            along_x, along_y = found.get("force_x", 0.0), found.get("force_y", 0.0)
            normal = normal + along_x * cos(x.phi) + along_y * sin(x.phi)
            tangential = tangential + along_y * cos(x.phi) - along_x * sin(x.phi)
        return normal, tangential

    return pair
