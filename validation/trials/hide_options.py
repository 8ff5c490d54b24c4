"""Hidden effects as options of the command line: EFFECT, EFFECT=SIZE, EFFECT=VALUE or EFFECT=NAME:VALUE,..."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from affine_model.effects import catalogue
from mujoco_ref.undeclared.strength import SCALED_TOGETHER, STRENGTH_SIZES, typical
from tentacle.errors import InputError
from tentacle.model import Model


def hidden_effects(options: Sequence[str], seed: int, model: Model) -> dict[str, str | float | Mapping[str, float]]:
    """--hide options as effects for undeclared.make; InputError where one cannot be read."""
    effects: dict[str, str | float | Mapping[str, float]] = {}
    for option in options:
        effect, _, text = option.partition("=")
        drawn = typical(effect, model, np.random.default_rng(seed))
        if effect in effects:
            raise InputError("is given twice", field=f"--hide {effect}", expected="each effect once")
        if text in ("", *STRENGTH_SIZES):
            effects[effect] = text or "visible"
            continue
        pairs = [pair.partition(":") for pair in text.split(",")]
        if not any(separator for _, separator, _ in pairs):
            if len(SCALED_TOGETHER[effect]) != 1:
                expected = ",".join(f"{name}:VALUE" for name in drawn) or "no value"
                raise InputError(f"{text!r} does not say of what", field=f"--hide {effect}", expected=expected)
            pairs = [(SCALED_TOGETHER[effect][0], ":", text)]
        try:
            values = drawn | {name: float(number) for name, _, number in pairs}
        except ValueError:
            raise InputError(f"{text!r} is not a number", field=f"--hide {effect}", expected="VALUE") from None
        _require_possible(effect, values)
        effects[effect] = values
    return effects


def _require_possible(effect: str, values: Mapping[str, float]) -> None:
    """InputError where a value of a catalogued effect is outside the bounds of what is physically possible."""
    known = catalogue()[effect].parameters if effect in catalogue() else ()
    for parameter in known:
        low, high = parameter.bounds
        value = values.get(parameter.name, low)
        if not low <= value <= high:
            expected = f"{low:g} to {high:g} {parameter.unit}".removesuffix(" 1")
            field = f"--hide {effect}.{parameter.name}"
            raise InputError(f"{value:g} is out of range", field=field, expected=expected)
