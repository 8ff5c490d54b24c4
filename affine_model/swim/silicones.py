"""Silicones that soft arms are cast of: one table, with sources and spreads; and models from it.

Sources. Modulus at 100 % strain and density: Smooth-On data sheets (Ecoflex 00-30 10 psi, Dragon Skin 10 Medium 22 psi,
Dragon Skin 20 49 psi). A data sheet's secant at 100 % lies below the tangent at small strain, in which an arm bends;
papers put that at 1.3 to 2 times as much (Marechal et al. 2021, Soft Robotics 8, 284, a common data base of them). The
middle is taken, the range is their spread. Loss factor tan delta at 1 Hz: .1 to .3 is measured of such silicones.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from tentacle.errors import InputError
from tentacle.model import Estimate, Model
from tentacle.specimen import WATER, Cone, Fluid, Gravity, Specimen


@dataclass(frozen=True)
class Silicone:
    """modulus E [Pa] of the tangent at small strain and the spread of published values; density [kg/m^3]; loss_factor,
    tan delta at 1 Hz, and its spread.
    """

    modulus: float
    modulus_range: tuple[float, float]
    density: float
    loss_factor: float = 0.15
    loss_range: tuple[float, float] = (0.1, 0.3)

    def viscosity(self, loss_factor: float | None = None) -> float:
        """eta [Pa s] of eq. 14 with that loss factor at 1 Hz: tan delta = eta omega / E."""
        return (loss_factor or self.loss_factor) * self.modulus / (2.0 * math.pi)


SILICONES = {
    "ecoflex-00-30": Silicone(0.9e5, (0.6e5, 1.25e5), 1070.0),
    "dragon-skin-10": Silicone(2.6e5, (1.5e5, 3.2e5), 1070.0),
    "dragon-skin-20": Silicone(5.0e5, (3.4e5, 7.2e5), 1080.0),
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
    eta, least, most = (material.viscosity(factor) for factor in (material.loss_factor, *material.loss_range))
    parameters = {
        "elasticity": {"E": Estimate(material.modulus, *material.modulus_range, "Pa")},
        "damping": {"eta": Estimate(eta, least, most, "Pa s")},
        "drag": {"C_perp": Estimate(1.1, 0.8, 1.5)},
        "added_mass": {"C_a": Estimate(1.0, 0.8, 1.2)},
    }
    return Model(specimen, fluid, gravity or Gravity(), parameters=parameters)
