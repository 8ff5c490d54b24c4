"""The paper's silicones and its cones, as models: for an arm that no one has measured yet, and for Table II."""

from __future__ import annotations

from dataclasses import dataclass

from tentacle.errors import InputError
from tentacle.model import Estimate, Model
from tentacle.specimen import WATER, Cone, Fluid, Gravity, Specimen


@dataclass(frozen=True)
class Silicone:
    """modulus E [Pa] of the tangent at small strain with the spread of published values, density [kg/m^3], viscosity
    eta [Pa s].
    """

    modulus: float
    modulus_range: tuple[float, float]
    density: float
    viscosity: float


# Data sheets (100 % modulus: Ecoflex 00-30 69 kPa, Dragon Skin 10 151 kPa, Dragon Skin 20 338 kPa) lie below the
# modulus at small strain that papers measure; the middle is taken, the range is their spread. Viscosity: a loss factor
# of about 0.07 at 1 Hz.
SILICONES = {
    "ecoflex-00-30": Silicone(0.9e5, (0.6e5, 1.25e5), 1070.0, 1.0e3),
    "dragon-skin-10": Silicone(2.6e5, (1.5e5, 3.2e5), 1070.0, 3.0e3),
    "dragon-skin-20": Silicone(5.0e5, (3.4e5, 7.2e5), 1080.0, 5.5e3),
}


def paper_cone(length: float) -> Specimen:
    """The paper's mould: a cone of 25 mm diameter at the base, cast to a 1 mm tip; length [m]."""
    return Specimen(Cone(0.0125, 0.001), length, SILICONES["dragon-skin-10"].density)


def assumed_model(specimen: Specimen, silicone: str, fluid: Fluid = WATER, gravity: Gravity | None = None) -> Model:
    """A model from textbook numbers: the silicone's E and eta, C_perp = 1.1 of a cylinder, added mass C_a = 1 of a
    circle.

    Intervals are those of the literature; an identified model replaces them. Raises InputError where the silicone is
    unknown.
    """
    if silicone not in SILICONES:
        raise InputError(f"{silicone!r} is not known", field="silicone", expected=f"one of {', '.join(SILICONES)}")
    material = SILICONES[silicone]
    parameters = {
        "elasticity": {"E": Estimate(material.modulus, *material.modulus_range, "Pa")},
        "damping": {"eta": Estimate(material.viscosity, 0.5 * material.viscosity, 2.0 * material.viscosity, "Pa s")},
        "drag": {"C_perp": Estimate(1.1, 0.8, 1.5)},
        "added_mass": {"C_a": Estimate(1.0, 0.8, 1.2)},
    }
    return Model(specimen, fluid, gravity or Gravity(), parameters=parameters)
