"""Drag coefficient of an oscillating section, C_d(Re, KC) along the taper: viscous part, beside C_perp.

With KC = U T / w, Re = U w / nu and b = Re / KC = f w^2 / nu, a cylinder that oscillates at f has

    C_d = C_perp + share (3 pi^3 / 2 KC) y (1 + y - y^2 / 4),    y = (pi b)^(-1/2).

At one frequency the second part is a linear resistance, the same at every amplitude: the first harmonic of
rho w C_d |u| u / 2 is 4 rho w C_d U^2 / (3 pi), so that along the normal

    f_n = -share 2 pi rho nu (1 / y + 1 - y / 4) u_n.

It does not depend on the amplitude, so it also holds at the base, where KC is small. share = 1 is the published law.
Experiments follow it where the flow is attached, KC up to about 1, and beside form drag up to about 2. For y > 1 (at
1 Hz a width under .6 mm) the resistance stays that of y = 1. `reynolds_drag` is the curve of a steady stream and
includes a viscous part: use one of the two in a model.
"""

from typing import Any

from affine_model.effect import Effect, Parameter
from affine_model.laws import magnitude, sqrt

VISCOSITY = 1.0e-6  # m^2/s, water at 20 degrees C
PI = 3.141592653589793


def _force(x: Any, p: Any) -> tuple[Any, Any]:
    inverse = sqrt(PI * p.f / VISCOSITY) * x.width  # 1 / y
    inverse = 0.5 * (inverse + 1.0 + magnitude(inverse - 1.0))
    resistance = 2.0 * PI * x.fluid_density * VISCOSITY * (inverse + 1.0 - 0.25 / inverse)
    return -p.share * resistance * x.u_n, 0.0


OSCILLATING_DRAG = Effect(
    name="oscillating_drag",
    title="Viscous drag of an oscillating section",
    parameters=(
        Parameter("share", "1", 1.0, (0.0, 10.0), "strength of the published law"),
        Parameter("f", "Hz", 1.2, (0.05, 10.0), "frequency of the motion", scan=(1.0,)),
    ),
    source="Stokes 1851; Wang 1968, J. Fluid Mech. 32: C_d(Re, KC); held against experiments by Sarpkaya 1986, J. Fluid"
    " Mech. 165",
    family="option",
    dissipative=True,
    force=_force,
)
