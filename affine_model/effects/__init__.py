"""The catalogue: every effect that stands in a file of this folder, found by itself. One file is one effect."""

from __future__ import annotations

import importlib
import pkgutil

from affine_model.effect import Effect
from affine_model.written_effect import effect_of
from tentacle.errors import InputError
from tentacle.law.in_use import follows_laws, laws_in_use


@follows_laws
def catalogue() -> dict[str, Effect]:
    """All effects by name, sorted: base effects first, then the others by name; those of the laws in use among them.

    Raises ValueError where two files define the same name, or a file holds no effect.
    """
    found: dict[str, Effect] = {}
    for module_info in pkgutil.iter_modules(__path__):
        module = importlib.import_module(f"{__name__}.{module_info.name}")
        effects = [value for value in vars(module).values() if isinstance(value, Effect)]
        if not effects:
            raise ValueError(f"affine_model/effects/{module_info.name}.py defines no Effect")
        for effect in effects:
            if effect.name in found:
                raise ValueError(f"two effects are named {effect.name!r}")
            found[effect.name] = effect
    for law in laws_in_use():
        if law.name in found:
            raise InputError("the catalogue has an effect of that name", field=law.name, expected="another name")
        found[law.name] = effect_of(law)
    return dict(sorted(found.items(), key=lambda item: (item[1].family != "base", item[0])))


def absent_effects() -> tuple[Effect, ...]:
    """The effects that the paper's model may lack, and that the loop seeks."""
    return tuple(effect for effect in catalogue().values() if effect.family not in ("base", "option"))
