"""Linear drag: viscous resistance in proportion to the speed;
along the tangent half of that along the normal (slender body).
"""

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
