"""Reactive force at a tip that sheds the water carried along: Lighthill's mean thrust.

Lighthill's force per length is -d/dt(m u_n n) + d/ds(m u_n u_t n - m u_n^2 t / 2) / L: the water's momentum m u_n n
changes, and the arm slips through it with u_t. Integrated by parts, the second term is the couple m u_n u_t of
`added_mass` plus, if the water leaves the arm, a force at the tip:

    F = m (u_n min(u_t, 0) n - u_n^2 t / 2),    m = rho pi span^2 / 4.

Added mass alone keeps the water's momentum and has no mean thrust. A tip with an edge (a fin) sheds this momentum as a
wake: for a small motion h of the tip in a stream U the mean thrust towards the base is m (h_t^2 - U^2 h_x^2) / 2. If
the tip leads (u_t > 0) it meets water at rest, which has no momentum. In both cases the arm gives the water the power m
u_n^2 |u_t| / 2. span is the extent of the edge across the plane of motion, 0 of a point (the default), twice its radius
of a cut cone.
"""

from typing import Any

from affine_model.effect import Effect, Parameter
from affine_model.laws import magnitude


def _force(x: Any, p: Any) -> tuple[Any, Any]:
    carried = 0.25 * 3.141592653589793 * x.fluid_density * p.span**2
    return carried * x.u_n * 0.5 * (x.u_t - magnitude(x.u_t)), -0.5 * carried * x.u_n**2


SHED_TIP = Effect(
    name="shed_tip",
    title="Thrust of a shedding tip",
    parameters=(Parameter("span", "m", 0.01, (0.0, 1.0), "extent of the tip's edge across the plane of motion"),),
    source="Lighthill 1971, Proc. R. Soc. B 179: large-amplitude elongated-body theory",
    family="option",
    dissipative=True,
    tip_force=_force,
)
