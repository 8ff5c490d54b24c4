"""Wall: near a plane beside the arm, at x = distance L, the normal flow is squeezed, and drag grows as (r/gap)^2."""

from affine_model.effect import Effect, Parameter

WALL = Effect(
    name="wall",
    title="Nearness of a wall",
    parameters=(
        Parameter("B", "1", 20.0, (0.0, 2000.0), "growth of the drag coefficient where the axis meets the wall"),
        Parameter(
            "distance",
            "arm lengths",
            0.6,
            (-3.0, 3.0),
            "where the wall stands, along n at theta = 0; its sign is the side",
            scan=(0.6, -0.6, 0.4, -0.4, 0.9, -0.9),
        ),
    ),
    source="Brennen 1982, sec. 4, leading order in (r/gap)^2, here on the drag",
    family="fluid",
    dissipative=True,
    force=lambda x, p: (
        -0.125
        * x.fluid_density
        * p.B
        * x.width**3
        * x.speed
        * x.u_n
        / ((p.distance * x.length - x.x) ** 2 + 0.25 * x.width**2),
        0.0,
    ),
)
