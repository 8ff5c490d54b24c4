"""Weight and buoyancy of the arm and its payload (eq. 10, with the section's own area)."""

from affine_model.effect import Effect

WEIGHT = Effect(
    name="weight",
    title="Weight and buoyancy",
    parameters=(),
    source="paper eq. 10",
    family="base",
    weight=lambda x, p: (x.density - x.fluid_density) * x.area,
)
