"""Sloshing: the water of the tank sways along n, in the lowest standing wave and in the next one that moves the middle:

    u(t) = Re[(U_cos - i U_sin) e^{i w t} + (V_cos - i V_sin) e^{i sqrt(3) w t}],  w = 2 pi f

In a deep tank of length l the standing waves have w_n^2 = g n pi / l. At its middle only waves of odd n move the water
sideways, so the second one has sqrt(3) times the first frequency. Both amplitudes are strengths: at a given f the force
is linear in them, so that one linear fit finds f from both spectral lines.
"""

from typing import Any

from affine_model.effect import Effect, Parameter
from affine_model.laws import cos, sin

SECOND_WAVE = 1.7320508075688772  # its frequency over that of the first


def _sway(x: Any, p: Any) -> tuple[Any, Any]:
    first = 6.283185307179586 * p.f * x.t
    second = SECOND_WAVE * first
    return p.U_cos * cos(first) + p.U_sin * sin(first) + p.V_cos * cos(second) + p.V_sin * sin(second), 0.0


SLOSHING = Effect(
    name="sloshing",
    title="Sloshing",
    parameters=(
        Parameter("U_cos", "m/s", 0.05, (-2.0, 2.0), "velocity amplitude in phase with cos(2 pi f t)"),
        Parameter("U_sin", "m/s", 0.05, (-2.0, 2.0), "velocity amplitude in phase with sin(2 pi f t)"),
        Parameter("V_cos", "m/s", 0.02, (-2.0, 2.0), "the same of the second wave, cos(2 pi sqrt(3) f t)"),
        Parameter("V_sin", "m/s", 0.02, (-2.0, 2.0), "the same of the second wave, sin(2 pi sqrt(3) f t)"),
        Parameter(
            "f",
            "Hz",
            1.2,
            (0.2, 4.0),
            "frequency",
            scan=(1.2, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.3, 1.4, 1.5, 1.6, 1.8, 2.0, 2.2, 2.5),
        ),
    ),
    source="Faltinsen and Timokha 2009, linear standing waves of a deep tank, uniform over the arm",
    family="fluid",
    water_velocity=_sway,
)
