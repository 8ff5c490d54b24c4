"""Dry friction in the material: a bending moment of constant size against c_rate, after a small elastic give."""

from affine_model.effect import Effect, Parameter

DRY_FRICTION = Effect(
    name="dry_friction",
    title="Dry friction in the material",
    parameters=(
        Parameter("c_f", "rad", 0.02, (0.0, 3.0), "friction moment over stiffness, the curvature that it holds"),
        Parameter("slip", "rad", 0.01, (1e-4, 1.0), "curvature at which it gives way", scan=(0.01, 0.001, 0.1)),
    ),
    source="Prandtl 1928, elastoplastic element; as internal friction: Kimball and Lovell 1927",
    family="elastic",
    dissipative=True,
    yield_curvature=lambda x, p: p.slip,
    bending_moment=lambda x, p: x.stiffness * p.c_f * x.memory / p.slip,
)
