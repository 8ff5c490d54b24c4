"""Dry friction in the material: m = k c_f [(1 - sliding) z / slip + sliding tanh(c_rate / rate)], against c_rate.

The first part is a spring that slips at a limit (z' = c_rate, |z| <= slip: an elastoplastic element). The second part
slides at every rate: Coulomb friction with a smooth change of sign. `sliding` is the share of the second part.
"""

from affine_model.effect import Effect, Parameter
from affine_model.laws import tanh

DRY_FRICTION = Effect(
    name="dry_friction",
    title="Dry friction in the material",
    parameters=(
        Parameter("c_f", "rad", 0.02, (0.0, 3.0), "friction moment over stiffness, the curvature that it holds"),
        Parameter("slip", "rad", 0.01, (1e-4, 1.0), "curvature at which it gives way", scan=(0.01, 0.001, 0.1)),
        Parameter("sliding", "1", 0.5, (0.0, 1.0), "share that depends on the rate alone", scan=(0.0, 1.0)),
        Parameter(
            "rate",
            "rad/s",
            0.5,
            (0.02, 20.0),
            "rate of curvature at which sliding friction is 3/4 of its size",
            scan=(0.5,),
        ),
    ),
    source="Prandtl 1928, elastoplastic element; Andersson, Soderberg and Bjorklund 2007, smoothed Coulomb friction; "
    "as internal friction: Kimball and Lovell 1927",
    family="elastic",
    dissipative=True,
    levels_off=True,
    yield_curvature=lambda x, p: p.slip,
    bending_moment=lambda x, p: (
        x.stiffness * p.c_f * ((1.0 - p.sliding) * x.memory / p.slip + p.sliding * tanh(x.c_rate / p.rate))
    ),
)
