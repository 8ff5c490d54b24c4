"""Tip mass: an undeclared weight fixed to the tip, with inertia, weight, buoyancy and the water that it carries.

Its centre lies at a reach beyond s = 1 along the tangent there, on the axis. It is as dense as the declared payload
(steel, where nothing else is declared), and so has its volume. How far a weight hangs beside the axis can be declared
([specimen] tip_mass_drop_m) but is not fitted: with it free, mass, reach and the camera's roll are not known apart on a
real beam (52 g became 157 g).
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
    source="Newton; Archimedes; Lamb 1932, art. 92: a sphere carries half the water that it displaces",
    family="weight",
    hung_mass=lambda x, p: (p.mass, p.reach * x.length, 0.0, x.payload_density),
)
