"""Amplitude-dependent damping: the material loses more where it is bent more,
in proportion to the size of the curvature.
"""

from affine_model.effect import Effect, Parameter
from affine_model.laws import sqrt

AMPLITUDE_DAMPING = Effect(
    name="amplitude_damping",
    title="Damping that grows with amplitude",
    parameters=(
        Parameter("b", "s/rad", 0.01, (0.0, 10.0), "loss over stiffness, per curvature: adds b k |c| to the damping d"),
    ),
    source="Payne 1962, softening and loss of filled elastomers with strain; lowest order in |c|",
    family="elastic",
    dissipative=True,
    bending_moment=lambda x, p: p.b * x.stiffness * sqrt(x.c**2 + 1e-4) * x.c_rate,
)
