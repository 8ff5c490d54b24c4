"""A joint answer as plain data, for a library's home: what the table, the page and scripts read."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from affine_model.effects import catalogue
from discovery.library.joint import FoundEffect, JointAnswer
from discovery.library.pooled import unit_of
from tentacle.signals import Array


def joint_data(answer: JointAnswer, contents: Sequence[str]) -> dict[str, Any]:
    """The answer of one arm; contents: the recordings' SHA-256, in the order of the answer."""
    return {
        "recordings": list(contents),
        "effects": [_effect(one, contents) for one in answer.effects],
        "parameters": [
            {
                "effect": effect,
                "parameter": name,
                "unit": unit_of(effect, name),
                "start": trend.start,
                "end": trend.end,
                "change": None if trend.change is None else list(trend.change),
                "p_value": trend.p_value,
                "changed": (effect, name) in answer.changed,
                "spread": trend.spread,
            }
            for (effect, name), trend in answer.trends.items()
        ],
        "false_claims": answer.false_claims,
        "mass_of_none": answer.mass_of_none,
    }


def _effect(one: FoundEffect, contents: Sequence[str]) -> dict[str, Any]:
    place = int(np.argmax(np.abs(one.direction.weights)))
    name = one.direction.columns[place][1]
    strength = next(s for s in catalogue()[one.names[0]].strengths if s.name == name)
    size = strength.nominal * one.direction.weights[place]
    return {
        "names": list(one.names),
        "masses": list(one.masses),
        "strengths": [
            {"parameter": parameter, "value": v, "low": low, "high": high, "unit": unit_of(one.names[0], parameter)}
            for parameter, (v, low, high) in one.strengths.items()
        ],
        "acts": _rounded(one.acts, 6),
        "claimed": [content for content, claimed in zip(contents, one.claimed, strict=True) if claimed],
        "shown_as": {"parameter": name, "unit": strength.unit},
        "estimates": _known(size * one.estimates, one.deviations),
        "deviations": _known(abs(size) * one.deviations, one.deviations),
    }


def _rounded(values: Array, digits: int) -> list[float]:
    return [round(float(value), digits) for value in values]


def _known(values: Array, deviations: Array) -> list[float | None]:
    """Values with None where a recording shows nothing."""
    return [float(v) if np.isfinite(d) else None for v, d in zip(values, deviations, strict=True)]
