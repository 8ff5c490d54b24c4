"""Soft spot: k(s) = k / (1 + C exp(-((s - s0) / 0.08)^2 / 2)): compliance added around s0 (a bubble, a crack).

depth = C / (1 + C) is the relative loss of stiffness at its middle. Compliances add along an arm: the spot adds
0.2 C times that of a uniform arm. C is at most 5, where it adds as much as the whole arm has. Beyond that it is a
hinge, and a hinge can imitate a payload.
"""

from typing import Any

from affine_model.effect import Effect, Parameter
from affine_model.laws import exp


def _stiffness_share(x: Any, p: Any) -> Any:
    left = 1.0 - p.depth
    return left / (left + p.depth * exp(-0.5 * ((x.s - p.s0) / 0.08) ** 2)) - 1.0


SOFT_SPOT = Effect(
    name="soft_spot",
    title="Soft spot",
    parameters=(
        Parameter("depth", "1", 0.3, (0.0, 5.0 / 6.0), "relative loss of stiffness at its middle"),
        Parameter("s0", "1", 0.3, (0.0, 1.0), "where it lies", scan=(0.3, 0.1, 0.2, 0.4, 0.5, 0.6, 0.7, 0.8)),
    ),
    source="Christides and Barr 1984, flexibility of a cracked beam; here with a Gaussian profile of width 0.08",
    family="elastic",
    stiffness_share=_stiffness_share,
)
