"""Buoyancy: the arm's density differs from the declared one, which changes its weight in the fluid and its inertia.

The bounds are those of cast elastomers: from foams (some 300 kg/m^3) to filled silicones (some 1700 kg/m^3).
"""

from affine_model.effect import Effect, Parameter

BUOYANCY = Effect(
    name="buoyancy",
    title="Density error",
    parameters=(Parameter("density_error", "kg/m^3", 50.0, (-700.0, 700.0), "true density less the declared one"),),
    source="Archimedes; eq. 10",
    family="weight",
    weight=lambda x, p: p.density_error * x.area,
    line_inertia=lambda x, p: p.density_error * x.area,
    rotary_inertia=lambda x, p: p.density_error * x.second_moment,
)
