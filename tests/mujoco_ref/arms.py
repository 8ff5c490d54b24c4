"""Arms and models that the reference's tests share."""

import numpy as np

from tentacle.model import Estimate, Model
from tentacle.specimen import AIR, WATER, Cone, Fluid, Gravity, Rectangle, Specimen

# The usual cone: L = .14 m, r 12.5 -> 1 mm, rho 1070, E = 2e5.
CONE = Specimen(Cone(0.0125, 0.001), 0.14, 1070.0)
STRIP = Rectangle(0.02, 0.01)
WEIGHTLESS = Gravity(0.0, 0.0)
HANGING = Gravity()
HORIZONTAL = Gravity(np.pi / 2)


def model_of(
    specimen: Specimen, fluid: Fluid = AIR, gravity: Gravity = WEIGHTLESS, **effects: dict[str, float]
) -> Model:
    """A model with E = 2e5 Pa unless given otherwise; effects by name, as plain numbers."""
    chosen = {"elasticity": {"E": 2e5}, **effects}
    exact = {effect: {name: Estimate.exact(v) for name, v in values.items()} for effect, values in chosen.items()}
    return Model(specimen, fluid, gravity, 2, exact)


def swimming_model(**effects: dict[str, float]) -> Model:
    """A usual silicone tentacle in water."""
    specimen = Specimen(Cone(0.0125, 0.0015), 0.14, 1070.0)
    base = {"damping": {"eta": 300.0}, "drag": {"C_perp": 1.1}}
    return model_of(specimen, WATER, HANGING, **{**base, **effects})
