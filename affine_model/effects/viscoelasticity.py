"""Viscoelasticity: one Maxwell branch in parallel, of relative modulus g and relaxation time tau."""

from affine_model.effect import Effect, Parameter

VISCOELASTICITY = Effect(
    name="viscoelasticity",
    title="Maxwell branch",
    parameters=(
        Parameter("g", "1", 0.2, (0.0, 20.0), "stiffness of the branch over that of the arm"),
        Parameter("tau", "s", 0.3, (0.005, 60.0), "relaxation time", scan=(0.3, 0.05, 0.1, 1.0, 3.0, 10.0)),
    ),
    source="Zener 1948, standard linear solid",
    family="elastic",
    dissipative=True,
    relaxation_time=lambda x, p: p.tau,
    bending_moment=lambda x, p: p.g * x.stiffness * x.memory,
)
