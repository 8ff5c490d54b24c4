"""Added mass: the water that a section carries along its normal (potential flow; a circle has C_a = 1)."""

from affine_model.effect import Effect, Parameter

ADDED_MASS = Effect(
    name="added_mass",
    title="Added mass",
    parameters=(Parameter("C_a", "1", 1.0, (0.0, 5.0), "added mass over that of the water in a circle of the width"),),
    source="Lighthill 1960; Morison et al. 1950, inertia term",
    family="fluid",
    normal_inertia=lambda x, p: 0.25 * 3.141592653589793 * p.C_a * x.fluid_density * x.width**2,
)
