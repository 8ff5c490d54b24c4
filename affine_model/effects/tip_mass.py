"""Tip mass: an undeclared mass fixed to the tip, with inertia and weight (heavy and small: no buoyancy of its own).

Its centre lies at a reach beyond s = 1, along the tangent there: a weight fixed to the end face stands ahead of it.
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
    ),
    source="Newton",
    family="weight",
    hung_mass=lambda x, p: (p.mass, p.reach * x.length),
)
