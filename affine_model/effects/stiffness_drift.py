"""Stiffness drift: the arm softens (or stiffens) while it is recorded, as it warms or takes up water:

k(t) = k (1 + rate (1 - exp(-settling t)) / settling),  or k (1 + rate t) if it does not settle.
"""

from typing import Any

from affine_model.effect import Effect, Parameter
from affine_model.laws import exp

SLOWEST = 1e-6  # 1/s: below this the drift is straight, to 1e-4 in a minute


def _share(x: Any, p: Any) -> Any:
    settling = p.settling + SLOWEST
    return p.rate * (1.0 - exp(-settling * x.t)) / settling


STIFFNESS_DRIFT = Effect(
    name="stiffness_drift",
    title="Drift of the stiffness",
    parameters=(
        Parameter("rate", "1/s", 2.0e-3, (-0.05, 0.05), "relative change of stiffness per second, at first"),
        Parameter("settling", "1/s", 0.1, (0.0, 1.0), "rate at which it comes to rest", scan=(0.0,)),
    ),
    source="first-order term in time; first-order relaxation to a new state",
    family="elastic",
    stiffness_share=_share,
)
