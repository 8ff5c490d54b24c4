"""Soft spot: the stiffness is locally smaller, around s0, by a relative depth (a bubble in the casting, a crack)."""

from affine_model.effect import Effect, Parameter
from affine_model.laws import exp

SOFT_SPOT = Effect(
    name="soft_spot",
    title="Soft spot",
    parameters=(
        Parameter("depth", "1", 0.3, (0.0, 0.95), "relative loss of stiffness at its middle"),
        Parameter("s0", "1", 0.3, (0.0, 1.0), "where it lies", scan=(0.3, 0.1, 0.2, 0.4, 0.5, 0.6, 0.7, 0.8)),
    ),
    source="Gaussian dip of k(s) of width 0.08",
    family="elastic",
    stiffness_share=lambda x, p: -p.depth * exp(-0.5 * ((x.s - p.s0) / 0.08) ** 2),
)
