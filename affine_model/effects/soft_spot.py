"""Soft spot: the stiffness falls locally, as by a bubble in the casting or a crack:

k(s) (1 - depth exp(-(s - s0)^2 / 2 extent^2)).
"""

from affine_model.effect import Effect, Parameter
from affine_model.laws import exp

SOFT_SPOT = Effect(
    name="soft_spot",
    title="Soft spot",
    parameters=(
        Parameter("depth", "1", 0.3, (0.0, 0.99), "relative loss of stiffness at its middle"),
        Parameter("s0", "1", 0.3, (0.0, 1.0), "where it lies", scan=(0.3, 0.1, 0.2, 0.4, 0.5, 0.6, 0.7, 0.8)),
        Parameter("extent", "1", 0.08, (0.02, 0.3), "standard deviation of the dip along s", scan=(0.08,)),
    ),
    source="Gaussian dip of k(s)",
    family="elastic",
    stiffness_share=lambda x, p: -p.depth * exp(-0.5 * ((x.s - p.s0) / p.extent) ** 2),
)
