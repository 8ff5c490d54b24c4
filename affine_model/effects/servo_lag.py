"""Servo lag: the clamp follows the recorded angle u late,

    (period / 2 pi)^2 theta'' + tau theta' + theta = u,

to first order, or to second, as a position loop with an inertia in it does.
"""

from typing import Any

from affine_model.base_laws import low_pass
from affine_model.curvature import Array
from affine_model.effect import Effect, Parameter


def _late(table: Array, step: float, p: Any) -> Array:
    """(period / 2 pi)^2 theta'' + tau theta' + theta = u"""
    return low_pass(table, step, p.tau, p.period)


SERVO_LAG = Effect(
    name="servo_lag",
    title="Lag of the servo",
    parameters=(
        Parameter("tau", "s", 0.02, (0.0, 0.5), "time constant of the lag"),
        Parameter("period", "s", 0.1, (0.0, 0.5), "natural period of the servo's loop; 0: first order", scan=(0.0,)),
    ),
    source="low-pass of first or second order between horn and clamp; Ogata 2010, ch. 5",
    family="servo",
    base=_late,
)
