"""Tip mass: an undeclared point mass at the tip, with its inertia and weight (heavy and small:
no buoyancy of its own).
"""

from affine_model.effect import Effect, Parameter

TIP_MASS = Effect(
    name="tip_mass",
    title="Mass at the tip",
    parameters=(Parameter("mass", "kg", 2.0e-3, (0.0, 10.0), "mass at s = 1"),),
    source="Newton",
    family="weight",
    tip_mass=lambda x, p: p.mass,
)
