"""Skin drag: friction of the water along the tangent, over the wetted perimeter."""

from affine_model.effect import Effect, Parameter

SKIN_DRAG = Effect(
    name="skin_drag",
    title="Tangential drag",
    parameters=(Parameter("C_t", "1", 0.05, (0.0, 5.0), "friction coefficient on the wetted perimeter"),),
    source="Taylor 1952; Hoerner 1965, ch. 2",
    family="fluid",
    dissipative=True,
    force=lambda x, p: (0.0, -0.5 * x.fluid_density * p.C_t * x.perimeter * x.speed * x.u_t),
)
