"""Tip mass: an undeclared weight fixed to the tip, with inertia, weight, buoyancy and added mass.

Its centre lies at a reach beyond s = 1 along the tangent there, and at a drop beside the axis. Its density is that of
the declared payload (steel by default), which gives its volume.
"""

from affine_model.effect import Effect, Parameter

TIP_MASS = Effect(
    name="tip_mass",
    title="Mass at the tip",
    parameters=(
        Parameter("mass", "kg", 2.0e-3, (0.0, 10.0), "mass"),
        Parameter(
            "reach", "arm lengths", 0.1, (-0.3, 0.3), "its centre beyond the tip, along the tangent", scan=(0.0,)
        ),
        Parameter(
            "drop", "arm lengths", 0.05, (-0.2, 0.2), "its centre beside the axis, along the normal", scan=(0.0,)
        ),
    ),
    source="Newton; Archimedes; Lamb 1932, art. 92: a sphere carries half the water that it displaces",
    family="weight",
    hung_mass=lambda x, p: (p.mass, p.reach * x.length, p.drop * x.length, x.payload_density),
)
