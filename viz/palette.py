"""Colours and dashes of all parties: the colour-blind safe set of Okabe and Ito (2008), with a dash for each
in print.
"""

from __future__ import annotations

from dataclasses import dataclass

RGB = tuple[int, int, int]


@dataclass(frozen=True)
class Role:
    """One party of the comparison: its name in a legend, colour (0..255 each) and matplotlib dash."""

    name: str
    colour: RGB
    dash: str

    @property
    def hex(self) -> str:
        """The colour as #rrggbb."""
        red, green, blue = self.colour
        return f"#{red:02x}{green:02x}{blue:02x}"

    def faint(self, alpha: int = 90) -> tuple[int, int, int, int]:
        """The colour with opacity alpha (0..255), for bands."""
        return (*self.colour, alpha)


MEASURED = Role("measured", (86, 180, 233), "-")
BASE = Role("base model", (230, 159, 0), "--")
MODEL = Role("model", (230, 159, 0), "--")  # where there is but one
AUGMENTED = Role("augmented model", (0, 158, 115), "-.")
REFERENCE = Role("reference", (204, 121, 167), ":")
WARNING = Role("rejected", (213, 94, 0), "-")
NEUTRAL = Role("", (140, 140, 140), "-")

SEQUENTIAL_MAP = "cividis"  # monotone in lightness, so it also reads in grey print
