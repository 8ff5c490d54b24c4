"""The paper's arms as far as it states them, and what had to be chosen where it does not."""

from __future__ import annotations

from tentacle.model import Estimate, Model
from tentacle.specimen import WATER, Cone, Specimen

BASE_RADIUS = 0.0125  # m: the specimens are 25 mm thick at the base (Fig. 5)
TIP_RADIUS = 0.001  # m: chosen; the print has a cone that ends in a point, a cast one does not
DENSITY = 1070.0  # kg/m^3: Smooth-On data sheets of the three silicones
# Young's modulus [Pa]: chosen. Dragon Skin 10 as measured (k0 = E I0/L = 36 mN m at 140 mm), the others from the data
# sheets' 100 % moduli (10 and 49 psi). The paper gives k0 and k1 of a single arm, whose unit is a misprint.
SILICONES = {"Eco-Flex": 6.9e4, "Dragon Skin 10": 2.6e5, "Dragon Skin 20": 3.4e5}
LOSS_TIME = 1.5e-3  # s: eta = E times this, chosen
DRAG, ADDED_MASS = 1.1, 1.0  # a cylinder across the flow; potential flow
CHOICES = (
    "Chosen where the paper is silent: tip radius 1 mm, Young's moduli 69, 260 and 340 kPa, material damping"
    " eta = E x 1.5 ms, C_perp = 1.1, C_a = 1."
)


def arm(length: float, silicone: str) -> Model:
    """An arm of that length [m] and silicone in water, hanging."""
    modulus = SILICONES[silicone]
    specimen = Specimen(Cone(BASE_RADIUS, TIP_RADIUS), length, DENSITY)
    model = Model(specimen, WATER).with_effect("elasticity", E=Estimate.exact(modulus, "Pa"))
    model = model.with_effect("damping", eta=Estimate.exact(LOSS_TIME * modulus, "Pa s"))
    model = model.with_effect("drag", C_perp=Estimate.exact(DRAG))
    return model.with_effect("added_mass", C_a=Estimate.exact(ADDED_MASS))
