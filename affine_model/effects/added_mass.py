"""Added mass: the water that a section carries along its normal (potential flow; a circle has C_a = 1).

A slender body carries none along its tangent; simulators that put the water's mass into their links carry it there
too.
"""

from typing import Any

from affine_model.effect import Effect, Parameter


def _carried(x: Any, p: Any) -> Any:
    """kg/m along the normal."""
    return 0.25 * 3.141592653589793 * p.C_a * x.fluid_density * x.width**2


ADDED_MASS = Effect(
    name="added_mass",
    title="Added mass",
    parameters=(
        Parameter("C_a", "1", 1.0, (0.0, 5.0), "added mass over that of the water in a circle of the width"),
        Parameter(
            "tangential", "1", 0.5, (0.0, 1.0), "that along the tangent, over that along the normal", scan=(0.0, 1.0)
        ),
    ),
    source="Lighthill 1960; Morison et al. 1950, inertia term",
    family="fluid",
    normal_inertia=lambda x, p: (1.0 - p.tangential) * _carried(x, p),
    carried_water=lambda x, p: p.tangential * _carried(x, p),
)
