"""Buoyancy: the arm's density is not what was declared; its weight in the fluid and its inertia change alike."""

from affine_model.effect import Effect, Parameter

BUOYANCY = Effect(
    name="buoyancy",
    title="Density error",
    parameters=(Parameter("density_error", "kg/m^3", 50.0, (-900.0, 3000.0), "true density less the declared one"),),
    source="Archimedes; eq. 10",
    family="weight",
    weight=lambda x, p: p.density_error * x.area,
    line_inertia=lambda x, p: p.density_error * x.area,
    rotary_inertia=lambda x, p: p.density_error * x.second_moment,
)
