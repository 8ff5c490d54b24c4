"""The quantities that a law's expression may use besides its own parameters, with their units.

Names and meanings are those of docs/catalogue.md. A law along the arm sees them at each section, one at the tip there.
"""

from __future__ import annotations

from tentacle.law.dimension import Dimension, dimension_of

_EVERYWHERE = {
    "t": "s", "x": "m", "y": "m", "phi": "rad", "phi_rate": "rad/s", "u_n": "m/s", "u_t": "m/s", "speed": "m/s",
    "length": "m", "density": "kg/m^3", "fluid_density": "kg/m^3", "gravity": "m/s^2",
}  # fmt: skip
_ALONG = {"s": "1", "area": "m^2", "width": "m", "perimeter": "m"}
_BENT = {"s": "1", "c": "rad", "c_rate": "rad/s", "stiffness": "N m", "memory": "rad", "t": "s", "length": "m"}

# acts -> the quantities that its law sees, and the unit of the law
ACTS: dict[str, tuple[dict[str, str], str]] = {
    "line": ({**_ALONG, **_EVERYWHERE}, "N/m"),
    "tip": (_EVERYWHERE, "N"),
    "moment": (_BENT, "N m"),
}
# Names of the models' other quantities: no parameter may have one of these.
RESERVED = frozenset().union(*(quantities for quantities, _ in ACTS.values())) | {
    "second_moment", "payload", "payload_reach", "payload_drop", "payload_density", "drag_coefficient",
}  # fmt: skip
SOFT = 1e-6  # SI: abs(z) is sqrt(z^2 + SOFT^2), so that every law has a slope
POSITIVE_ROUNDING = 1e-4  # SI: positive(z) is (z + sqrt(z^2 + CORNER^2)) / 2, rounded over .1 mm
SIGN_WIDTH = 1e-3  # SI: sign(z) is tanh(z / SIGN_WIDTH)


def dimensions(acts: str) -> tuple[dict[str, Dimension], Dimension]:
    """Dimensions of the quantities that a law of that kind sees, and of the law itself."""
    quantities, unit = ACTS[acts]
    return {name: dimension_of(own) for name, own in quantities.items()}, dimension_of(unit)
