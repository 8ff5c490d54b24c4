"""Physical dimensions as exponents of metre, kilogram and second; an angle and a share have none."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction

_SYMBOLS = {
    "1": (0, 0, 0), "rad": (0, 0, 0), "m": (1, 0, 0), "kg": (0, 1, 0), "s": (0, 0, 1), "Hz": (0, 0, -1),
    "N": (1, 1, -2), "Pa": (-1, 1, -2), "J": (2, 1, -2), "W": (2, 1, -3),
}  # fmt: skip
_FACTOR = re.compile(r"([A-Za-z]+|1)(?:\^(-?\d+(?:\.\d+)?(?:/\d+)?))?$")


@dataclass(frozen=True)
class Dimension:
    """metre^length kilogram^mass second^time."""

    length: Fraction = Fraction(0)
    mass: Fraction = Fraction(0)
    time: Fraction = Fraction(0)

    def __mul__(self, other: Dimension) -> Dimension:
        return Dimension(self.length + other.length, self.mass + other.mass, self.time + other.time)

    def __truediv__(self, other: Dimension) -> Dimension:
        return self * other ** Fraction(-1)

    def __pow__(self, exponent: Fraction) -> Dimension:
        return Dimension(self.length * exponent, self.mass * exponent, self.time * exponent)

    def __str__(self) -> str:
        parts = [("m", self.length), ("kg", self.mass), ("s", self.time)]
        return " ".join(name if power == 1 else f"{name}^{power}" for name, power in parts if power) or "1"


DIMENSIONLESS = Dimension()


def dimension_of(unit: str) -> Dimension:
    """The dimension of a unit such as "N/m^2", "Pa s" or "1/s^1.5".

    ValueError if it is not made of SI units. A slash divides by the next factor only. Prefixes (mm, kPa) are refused,
    because values must be in SI units.
    """
    found = DIMENSIONLESS
    for sign, factor in re.findall(r"(/?)\s*([^\s/*]+)", unit):
        match = _FACTOR.match(factor)
        if match is None or match[1] not in _SYMBOLS:
            raise ValueError(f"{factor!r} is no SI unit without a prefix")
        power = Fraction(match[2] or "1").limit_denominator(1000)
        one = Dimension(*(Fraction(exponent) for exponent in _SYMBOLS[match[1]]))
        found = found * one ** (-power if sign else power)
    if not unit.strip():
        raise ValueError("a unit is missing; a number without one has the unit 1")
    return found
