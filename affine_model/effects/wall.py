"""Wall: a plane beside the arm, at x = distance L. Near it the flow is squeezed: more added mass, and more drag.

With h the axis' distance from the wall, r half the width: added mass per length, along the normal,
pi rho r^2 (r/h)^2 / 2 beyond that of free water (potential flow, leading order), and C_perp / (2 + 10 e/D) more drag,
e/D = (h - r) / 2r the gap in diameters. `carried` is the share of that added mass which acts: 1 for a smooth wall in
still water, 0 for a wall that only adds drag. Both stay finite if the axis meets the wall. The added mass m depends on
the place, so momentum and energy require the forces -m' x' u_n n + m' u_n^2 / 2 along x.

The drag follows the published factor 0.9 + 0.5 / (1 + 5 e/D), which reaches 1 at e/D = 0.8 and ends there. The law here
uses 1 in place of 0.9, so that it has no kink: at B = 1 it is 0.1 C_perp larger up to e/D = 0.8, and goes on falling
beyond.
"""

from typing import Any

from affine_model.effect import Effect, Parameter
from affine_model.laws import cos, sin, sqrt


def _inertia(x: Any, p: Any) -> Any:
    """kg/m along the normal."""
    radius_squared, away = 0.25 * x.width**2, p.distance * x.length - x.x
    return (
        p.carried
        * p.B
        * 0.5
        * 3.141592653589793
        * x.fluid_density
        * radius_squared**2
        / (away**2 + 0.25 * radius_squared)
    )


def _force(x: Any, p: Any) -> tuple[Any, Any]:
    radius, away = 0.5 * x.width, p.distance * x.length - x.x
    gap = 0.5 * (sqrt(away**2 + radius**2) / radius - 1.0)
    drag = -0.5 * x.fluid_density * x.drag_coefficient * p.B * 0.5 / (1.0 + 5.0 * gap) * x.width * x.speed * x.u_n
    slope = _inertia(x, p) * 2.0 * away / (away**2 + 0.25 * radius**2)  # of the added mass, along x
    along_x = x.u_n * cos(x.phi) - x.u_t * sin(x.phi)
    lift = 0.5 * slope * x.u_n**2
    return drag - slope * along_x * x.u_n + lift * cos(x.phi), -lift * sin(x.phi)


WALL = Effect(
    name="wall",
    title="Nearness of a wall",
    parameters=(
        Parameter("B", "1", 5.0, (0.0, 200.0), "its strength, over the published one of a smooth cylinder (1)"),
        Parameter(
            "distance",
            "arm lengths",
            0.6,
            (-3.0, 3.0),
            "where the wall stands, along n at theta = 0; its sign is the side",
            scan=(0.6, -0.6, 0.4, -0.4, 0.9, -0.9),
        ),
        Parameter("carried", "1", 1.0, (0.0, 1.0), "share of the published added mass that acts", scan=(1.0, 0.0)),
    ),
    source="added mass: Brennen 1982, sec. 4; drag: after DNV-RP-F105, proximity to a wall",
    family="fluid",
    normal_inertia=_inertia,
    force=_force,
)
