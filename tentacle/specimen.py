"""The arm and what surrounds it: section, specimen, fluid, gravity. Frozen, SI units, no parameter that is fitted."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tentacle.errors import InputError

STANDARD_GRAVITY = 9.80665  # m/s^2, ISO 80000-3
STEEL = 7850.0  # kg/m^3

StiffnessLaw = Literal["section", "affine"]
AddedMass = Literal["none", "section", "fit"]
# Added mass of a rectangle over pi rho a^2, a half its width across the flow, by its height along the flow over its
# width (DNV-RP-C205, table D-1; a circle: 1).
_FLATNESS = (0.0, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)
_RECTANGLE = (1.0, 1.14, 1.21, 1.36, 1.51, 1.70, 1.98, 2.23)
Array = NDArray[np.float64]


def _require_positive(**values: float) -> None:
    for name, value in values.items():
        if not (np.isfinite(value) and value > 0):
            raise InputError(f"{value!r} is not usable", field=name, expected="a positive number")


MOST_SHEAR = 10.0  # times that of an incompressible solid: a porous or layered section
LARGEST_RADIUS = 100.0  # m: no arm is thicker; the fourth power of what a wrong file states would overflow


@dataclass(frozen=True)
class Cone:
    """A circular cone, or truncated cone: radius base_radius [m] at s = 0, tip_radius [m] at s = 1."""

    base_radius: float
    tip_radius: float

    def __post_init__(self) -> None:
        _require_positive(base_radius_m=self.base_radius)
        if not (np.isfinite(self.tip_radius) and self.tip_radius >= 0):
            raise InputError(f"{self.tip_radius!r} is not usable", field="tip_radius_m", expected="a number >= 0")
        for name, radius in (("base_radius_m", self.base_radius), ("tip_radius_m", self.tip_radius)):
            if radius > LARGEST_RADIUS:
                raise InputError(f"{radius!r} is not usable", field=name, expected=f"metres, up to {LARGEST_RADIUS:g}")

    def half_thickness(self, s: ArrayLike) -> Array:
        """Half the extent along the normal n, in the plane of motion [m]: the radius r(s) = r0 + (r_tip - r0) s."""
        return self.base_radius + (self.tip_radius - self.base_radius) * np.asarray(s, dtype=float)

    def width(self, s: ArrayLike) -> Array:
        """Extent across the plane of motion [m], the width that normal flow meets: 2 r(s)."""
        return 2.0 * self.half_thickness(s)

    def area(self, s: ArrayLike) -> Array:
        """Section area A(s) = pi r^2 [m^2]."""
        return np.pi * self.half_thickness(s) ** 2

    def second_moment(self, s: ArrayLike) -> Array:
        """Second moment of area about the bending axis, I_a(s) = pi r^4 / 4 [m^4]."""
        return 0.25 * np.pi * self.half_thickness(s) ** 4

    def perimeter(self, s: ArrayLike) -> Array:
        """Wetted perimeter 2 pi r(s) [m]."""
        return 2.0 * np.pi * self.half_thickness(s)

    @property
    def added_mass(self) -> float:
        """C_a: water carried along the normal, over that in a circle of the width."""
        return 1.0

    @property
    def shear_coefficient(self) -> float:
        """kappa of an incompressible circle (Cowper 1966)."""
        return 0.9


@dataclass(frozen=True)
class Rectangle:
    """A constant rectangle: width [m] across the plane of motion, height [m] along the normal n, in the plane."""

    section_width: float
    height: float

    def __post_init__(self) -> None:
        _require_positive(width_m=self.section_width, height_m=self.height)

    def half_thickness(self, s: ArrayLike) -> Array:
        """Half the extent along the normal n, in the plane of motion [m]."""
        return np.full_like(np.asarray(s, dtype=float), 0.5 * self.height)

    def width(self, s: ArrayLike) -> Array:
        """Extent across the plane of motion [m], the width that normal flow meets."""
        return np.full_like(np.asarray(s, dtype=float), self.section_width)

    def area(self, s: ArrayLike) -> Array:
        """Section area [m^2]."""
        return np.full_like(np.asarray(s, dtype=float), self.section_width * self.height)

    def second_moment(self, s: ArrayLike) -> Array:
        """Second moment of area about the bending axis, w h^3 / 12 [m^4]."""
        return np.full_like(np.asarray(s, dtype=float), self.section_width * self.height**3 / 12.0)

    def perimeter(self, s: ArrayLike) -> Array:
        """Wetted perimeter 2 (w + h) [m]."""
        return np.full_like(np.asarray(s, dtype=float), 2.0 * (self.section_width + self.height))

    @property
    def added_mass(self) -> float:
        """C_a: water carried along the normal, over that in a circle of the width."""
        return float(np.interp(self.height / self.section_width, _FLATNESS, _RECTANGLE))

    @property
    def shear_coefficient(self) -> float:
        """kappa of an incompressible rectangle (Cowper 1966)."""
        return 6.0 / 7.0


Section = Cone | Rectangle


@dataclass(frozen=True)
class Specimen:
    """The arm as measured with ruler and scales.

    length [m], density [kg/m^3], tip_mass [kg] (declared payload). stiffness says which law the fit
    uses for k(s) and d(s): "section" (k = E I(s)/L, d = eta I(s)/L) or "affine" (k0 + k1 s, d0 + d1 s; eq. 13-14).
    The payload's centre lies tip_mass_reach [m] beyond s = 1 along the tangent, and tip_mass_drop [m] beside the axis
    along the normal; tip_mass_density [kg/m^3] gives its volume. tip_rounding [m]: radius with which the end of the
    silicone is rounded in a side view, 0 for a flat cut, None if unknown; the length ends at the outermost point. It
    shapes the outline in a picture only: mass and stiffness neglect the silicone that a rounding takes off.
    laws: effects of the catalogue that are known to act in this arm, with unknown strength. clamp_length [m]: how much
    the clamp gives. It turns as much as a further length l of the arm's root would bend, massless and dry: its
    stiffness is k(0) L / l, that of an elastic section E I(0) / l. 0 is a rigid clamp. shear_compliance: how much the
    sections shear, over those of an incompressible solid (Timoshenko 1921). 0: they stand square to the midline.
    """

    section: Section
    length: float
    density: float
    tip_mass: float = 0.0
    stiffness: StiffnessLaw = "section"
    tip_mass_reach: float = 0.0
    tip_mass_drop: float = 0.0
    tip_mass_density: float = STEEL
    tip_rounding: float | None = None
    laws: tuple[str, ...] = ()
    clamp_length: float = 0.0
    shear_compliance: float = 0.0

    def __post_init__(self) -> None:
        _require_positive(
            length_m=self.length, density_kg_m3=self.density, tip_mass_density_kg_m3=self.tip_mass_density
        )
        for name, place in (("tip_mass_reach_m", self.tip_mass_reach), ("tip_mass_drop_m", self.tip_mass_drop)):
            if not abs(place) <= self.length:
                raise InputError(f"{place!r} is not usable", field=name, expected="metres, within an arm's length")
        if not (np.isfinite(self.tip_mass) and self.tip_mass >= 0):
            raise InputError(f"{self.tip_mass!r} is not usable", field="tip_mass_kg", expected="a number >= 0")
        if not 0.0 <= self.clamp_length <= self.length:
            expected = "metres, from 0 (rigid) to an arm's length"
            raise InputError(f"{self.clamp_length!r} is not usable", field="clamp_length_m", expected=expected)
        if not 0.0 <= self.shear_compliance <= MOST_SHEAR:
            expected = f"a number from 0 (no shear) to {MOST_SHEAR:g}; 1: an incompressible solid"
            raise InputError(f"{self.shear_compliance!r} is not usable", field="shear_compliance", expected=expected)
        rounding, widest = self.tip_rounding, float(self.section.half_thickness(1.0))
        if rounding is not None and not 0.0 <= rounding <= widest * (1.0 + 1e-9):
            expected = f"metres, from 0 (a flat cut) to the tip's radius of {widest:g}"
            raise InputError(f"{rounding!r} is not usable", field="tip_rounding_m", expected=expected)
        if self.stiffness not in ("section", "affine"):
            raise InputError(f"{self.stiffness!r} is not known", field="stiffness", expected='"section" or "affine"')

    def seen_half_thickness(self, s: ArrayLike) -> Array:
        """Half the thickness in the plane of motion [m], with the rounded end: r(s) - R + sqrt(R^2 - (R - d)^2).

        R is the tip's rounding, d = L (1 - s) < R the distance from the end.
        """
        s = np.asarray(s, dtype=float)
        half, rounding = self.section.half_thickness(s), self.tip_rounding or 0.0
        inward = np.clip(rounding - self.length * (1.0 - s), 0.0, rounding)
        return np.asarray(half - rounding + np.sqrt(rounding**2 - inward**2))

    @property
    def clamp_share(self) -> float:
        """l / L, how much the clamp gives, over the arm's length."""
        return self.clamp_length / self.length

    @property
    def mass(self) -> float:
        """Mass of the arm without payload [kg]; exact, since A(s) is a polynomial of degree <= 2 (Simpson)."""
        area = self.section.area(np.array([0.0, 0.5, 1.0]))
        return float(self.density * self.length * (area[0] + 4.0 * area[1] + area[2]) / 6.0)


@dataclass(frozen=True)
class Fluid:
    """The fluid around the arm; density [kg/m^3], 0 means air (no fluid force).

    added_mass: the declared added mass of the arm. "none": nothing (the paper's model);
    "section": C_a of the section, known; "fit": C_a is fitted with the base parameters.
    """

    density: float = 0.0
    added_mass: AddedMass = "none"

    def __post_init__(self) -> None:
        if self.added_mass not in ("none", "section", "fit"):
            raise InputError(
                f"{self.added_mass!r} is not known", field="added_mass", expected='"none", "section", "fit"'
            )
        if not (np.isfinite(self.density) and self.density >= 0):
            raise InputError(f"{self.density!r} is not usable", field="density_kg_m3", expected="a number >= 0")


def densest(fluids: Iterable[Fluid]) -> Fluid:
    """The one of several fluids with the largest density."""
    return max(fluids, key=lambda fluid: fluid.density)


WATER = Fluid(998.0)
AIR = Fluid(0.0)


@dataclass(frozen=True)
class Gravity:
    """Direction of gravity: it pulls along magnitude (sin a, cos a) in (n, along the straight arm) at theta = 0.

    a = angle [rad]: 0 hangs down, pi stands up, +-pi/2 is held horizontally. magnitude in m/s^2.
    """

    angle: float = 0.0
    magnitude: float = STANDARD_GRAVITY


HANGING_DOWN = Gravity()


def declared_effects(specimen: Specimen, fluid: Fluid) -> dict[str, dict[str, float]]:
    """Effects in the model because of the declaration: name -> parameter -> value (the start, if it is fitted).

    Added mass acts along the normal only (Kirchhoff).
    """
    if fluid.density <= 0.0 or fluid.added_mass == "none":
        return {}
    return {"added_mass": {"C_a": specimen.section.added_mass, "tangential": 0.0}}
