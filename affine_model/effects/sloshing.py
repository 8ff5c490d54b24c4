"""Sloshing: the water of the tank sways to and fro along n with one frequency (lowest standing wave)."""

from affine_model.effect import Effect, Parameter
from affine_model.laws import cos, sin

SLOSHING = Effect(
    name="sloshing",
    title="Sloshing",
    parameters=(
        Parameter("U_cos", "m/s", 0.05, (-2.0, 2.0), "velocity amplitude in phase with cos(2 pi f t)"),
        Parameter("U_sin", "m/s", 0.05, (-2.0, 2.0), "velocity amplitude in phase with sin(2 pi f t)"),
        Parameter(
            "f",
            "Hz",
            1.2,
            (0.2, 4.0),
            "frequency",
            scan=(1.2, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.3, 1.4, 1.5, 1.6, 1.8, 2.0, 2.2, 2.5),
        ),
    ),
    source="Faltinsen and Timokha 2009, linear standing wave, uniform over the arm",
    family="fluid",
    water_velocity=lambda x, p: (
        p.U_cos * cos(6.283185307179586 * p.f * x.t) + p.U_sin * sin(6.283185307179586 * p.f * x.t),
        0.0,
    ),
)
