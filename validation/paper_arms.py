"""The paper's arms, with the values that the paper does not state."""

from __future__ import annotations

from affine_model.swim.silicones import SILICONES as TABLE
from tentacle.model import Estimate, Model
from tentacle.specimen import WATER, Cone, Specimen

BASE_RADIUS = 0.0125  # m: the specimens are 25 mm thick at the base (Fig. 5)
TIP_RADIUS = 0.001  # m: chosen; the paper's cone ends in a point, which cannot be cast
# The paper names the silicones; their properties are in affine_model.swim.silicones. The paper gives k0 and k1 of a
# single arm, with a misprint in the unit: E I0/L of Dragon Skin 10 at 140 mm is 36 mN m.
PAPER_SILICONES = {
    "Eco-Flex": TABLE["ecoflex-00-30"],
    "Dragon Skin 10": TABLE["dragon-skin-10"],
    "Dragon Skin 20": TABLE["dragon-skin-20"],
}
DRAG, ADDED_MASS = 1.1, 1.0  # a cylinder across the flow; potential flow
_MODULI = ", ".join(f"{1e-3 * silicone.modulus:.0f}" for silicone in PAPER_SILICONES.values())
CHOICES = (
    f"Chosen where the paper is silent: tip radius 1 mm, Young's moduli {_MODULI} kPa, loss factor"
    f" {TABLE['dragon-skin-10'].loss_factor:g} at 1 Hz, C_perp = 1.1, C_a = 1."
)


def paper_arm(length: float, silicone: str) -> Model:
    """An arm of that length [m] and silicone in water, hanging."""
    material = PAPER_SILICONES[silicone]
    specimen = Specimen(Cone(BASE_RADIUS, TIP_RADIUS), length, material.density)
    model = Model(specimen, WATER).with_effect("elasticity", E=Estimate.exact(material.modulus, "Pa"))
    model = model.with_effect("damping", eta=Estimate.exact(material.viscosity(), "Pa s"))
    model = model.with_effect("drag", C_perp=Estimate.exact(DRAG))
    return model.with_effect("added_mass", C_a=Estimate.exact(ADDED_MASS))
