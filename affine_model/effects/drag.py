"""Drag along the normal, quadratic in the speed relative to the water (eq. 15; eq. 16-17 lack the L of L ds)."""

from affine_model.effect import Effect, Parameter

DRAG = Effect(
    name="drag",
    title="Normal drag",
    parameters=(Parameter("C_perp", "1", 1.0, (0.0, 20.0), "drag coefficient of the section across the flow"),),
    source="paper eq. 15",
    family="base",
    dissipative=True,
    drag_coefficient=lambda x, p: p.C_perp,
    force=lambda x, p: (-0.5 * x.fluid_density * x.drag_coefficient * x.width * x.speed * x.u_n, 0.0),
)
