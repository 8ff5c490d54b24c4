"""Elasticity: k(s) c with k = E I(s)/L (the section's law) or k = k0 + k1 s (the paper's).

Eq. 11-12 print alpha^2 where only c^2 leads to eq. 13: U = 1/2 int k(s) c^2 ds.
"""

from affine_model.effect import Effect, Parameter

ELASTICITY = Effect(
    name="elasticity",
    title="Elasticity",
    parameters=(
        Parameter("E", "Pa", 2.0e5, (0.0, 1.0e8), "Young's modulus"),
        Parameter("k0", "N m/rad", 1.0e-2, (-1.0e3, 1.0e3), "flexural stiffness at the base"),
        Parameter("k1", "N m/rad", 1.0e-2, (-1.0e3, 1.0e3), "its change from base to tip"),
    ),
    source="paper eq. 11-13, c^2 for alpha^2",
    family="base",
    stiffness=lambda x, p: p.E * x.second_moment / x.length + p.k0 + p.k1 * x.s,
)
