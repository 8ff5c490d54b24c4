"""Cubic stiffness: the material hardens (beta > 0) or softens with curvature, k (1 + beta c^2) c.

c is counted from the natural curvature, the shape at rest of an arm that was cast curved.
"""

from affine_model.effect import Effect, Parameter

CUBIC_STIFFNESS = Effect(
    name="cubic_stiffness",
    title="Cubic stiffness",
    parameters=(Parameter("beta", "1/rad^2", 0.1, (-2.0, 20.0), "relative change of stiffness per squared curvature"),),
    source="Duffing 1918; lowest odd term of a hyperelastic section",
    family="elastic",
    bending_moment=lambda x, p: p.beta * x.stiffness * x.c**3,
)
