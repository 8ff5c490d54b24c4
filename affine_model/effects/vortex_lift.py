"""Vortex-induced force of a stream across the plane of motion: vortices are shed at the frequency 0.2 U / width.

Lift is at right angles to stream and arm, so only a stream perpendicular to the plane of motion gives a force in the
plane.
"""

from affine_model.effect import Effect, Parameter
from affine_model.laws import cos, sin

STROUHAL = 0.2  # of a smooth cylinder, 300 < Re < 2e5
TURN = 6.283185307179586

VORTEX_LIFT = Effect(
    name="vortex_lift",
    title="Lift of shed vortices",
    parameters=(
        Parameter("C_cos", "1", 0.3, (-3.0, 3.0), "lift coefficient in phase with cos(2 pi f t)"),
        Parameter("C_sin", "1", 0.3, (-3.0, 3.0), "lift coefficient in phase with sin(2 pi f t)"),
        Parameter("U", "m/s", 0.1, (0.0, 2.0), "speed of the stream across the plane of motion", scan=(0.1,)),
    ),
    source="Blevins 1990, Flow-Induced Vibration, ch. 3",
    family="option",
    force=lambda x, p: (
        0.5
        * x.fluid_density
        * x.width
        * p.U**2
        * (p.C_cos * cos(TURN * STROUHAL * p.U / x.width * x.t) + p.C_sin * sin(TURN * STROUHAL * p.U / x.width * x.t)),
        0.0,
    ),
)
