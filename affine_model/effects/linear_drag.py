"""Linear drag: viscous resistance proportional to the speed; half as large along the tangent as along the normal."""

from affine_model.effect import Effect, Parameter

LINEAR_DRAG = Effect(
    name="linear_drag",
    title="Linear drag",
    parameters=(Parameter("c_n", "Pa s", 0.5, (0.0, 100.0), "normal force per length and speed"),),
    source="Gray and Hancock 1955, resistive force theory",
    family="fluid",
    dissipative=True,
    force=lambda x, p: (-p.c_n * x.u_n, -0.5 * p.c_n * x.u_t),
)
