"""Dry friction in the material: a bending moment of constant size against c_rate (smoothed at 0.05 rad/s)."""

from affine_model.effect import Effect, Parameter
from affine_model.laws import tanh

DRY_FRICTION = Effect(
    name="dry_friction",
    title="Dry friction in the material",
    parameters=(
        Parameter("c_f", "rad", 0.02, (0.0, 3.0), "friction moment over stiffness, the curvature at which it yields"),
    ),
    source="Coulomb; as internal friction: Kimball and Lovell 1927",
    family="elastic",
    dissipative=True,
    bending_moment=lambda x, p: x.stiffness * p.c_f * tanh(x.c_rate / 0.05),
)
