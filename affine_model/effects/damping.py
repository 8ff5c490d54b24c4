"""Material damping: d(s) c_rate with d = eta I(s)/L (Kelvin-Voigt section) or d = d0 + d1 s (eq. 14)."""

from affine_model.effect import Effect, Parameter

DAMPING = Effect(
    name="damping",
    title="Material damping",
    parameters=(
        Parameter("eta", "Pa s", 1.0e3, (0.0, 1.0e7), "viscosity of the material"),
        Parameter("d0", "N m s/rad", 1.0e-4, (-1.0e2, 1.0e2), "flexural damping at the base"),
        Parameter("d1", "N m s/rad", 1.0e-4, (-1.0e2, 1.0e2), "its change from base to tip"),
    ),
    source="paper eq. 14; Kelvin-Voigt",
    family="base",
    dissipative=True,
    bending_moment=lambda x, p: (p.eta * x.second_moment / x.length + p.d0 + p.d1 * x.s) * x.c_rate,
)
