"""Intrinsic curvature: the arm was cast curved, or has become so.

Its curvature at rest is c = c0 (1 + slope (s - 1/2)).
"""

from affine_model.effect import Effect, Parameter

INTRINSIC_CURVATURE = Effect(
    name="intrinsic_curvature",
    title="Curvature at rest",
    parameters=(
        Parameter("c0", "rad", 0.1, (-6.3, 6.3), "mean curvature of the unloaded arm, per unit s"),
        Parameter("slope", "1", 1.0, (-3.0, 3.0), "its change from base to tip, over its mean", scan=(0.0,)),
    ),
    source="Antman 2005, ch. 4, naturally curved rod",
    family="elastic",
    natural_curvature=lambda x, p: p.c0 * (1.0 + p.slope * (x.s - 0.5)),
)
