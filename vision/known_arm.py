"""What is known of an arm before it is found in a film. It selects among the slender bodies in view."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tentacle.signals import Array
from vision.arm_proposal import ArmProposal

LENGTH_ALIKE = 1.25  # times: largest ratio of a proposed length to the known one; a part of the arm may be hidden
STOUT_ALIKE = 1.6  # times: the same of length over width, right to 4 % in drawn films; half a width is an error of 2
IN_VIEW = "the slender body in view"


@dataclass(frozen=True)
class KnownArm:
    """base_px (u, v); length_px; slender: the length over the width at the base. None for what is not known."""

    base_px: tuple[float, float] | None = None
    length_px: float | None = None
    slender: float | None = None

    def base(self) -> Array | None:
        """The base (2,) [px]."""
        return None if self.base_px is None else np.array(self.base_px)

    def shrunk(self, times: int) -> KnownArm:
        """The same in pictures that are so many times as small."""
        base, length = self.base_px, self.length_px
        if base is not None:
            base = ((base[0] + 0.5) / times - 0.5, (base[1] + 0.5) / times - 0.5)
        return KnownArm(base, None if length is None else length / times, self.slender)

    def against(self, found: ArmProposal) -> str:
        """Why a proposal is not this arm, in words; "" if it may be."""
        if self.length_px is not None and not _alike(found.length_px, self.length_px, LENGTH_ALIKE):
            return f"{IN_VIEW} is {found.length_px:.0f} px long; by its scale the arm is {self.length_px:.0f} px"
        slender = found.length_px / max(found.width_px[0], 1.0)
        if self.slender is not None and not _alike(slender, self.slender, STOUT_ALIKE):
            return f"{IN_VIEW} is {slender:.1f} times as long as wide at its base; the arm is {self.slender:.1f} times"
        return ""


NOTHING_KNOWN = KnownArm()


def _alike(one: float, other: float, most: float) -> bool:
    return 1.0 / most < one / max(other, 1e-9) < most
