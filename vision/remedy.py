"""Reasons why an arm is not found, or lost in most frames: differences between the picture and the declaration."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tentacle.errors import InputError
from vision.kinematics import Geometry
from vision.propose import propose_arm

ANOTHER_PLACE = 0.12  # of the arm's length: a larger distance of the base is reported
ANOTHER_SCALE = 0.12  # relative: a larger difference of the length is reported
TURNED = 1.2  # rad
WATCHED = 30  # frames without repeats, after which a loss is reported
LOST = 0.5  # share of them
SLOW, LATE = 1.0, 4.0  # s a frame, and s since the start: slower than this is reported


def remedies(image: NDArray[np.uint8], geometry: Geometry, servo: bool) -> list[str]:
    """Proposed changes of the declaration, in words; [] if the picture agrees with it. servo: whether its angle is
    known.
    """
    try:
        seen = propose_arm(image)
    except InputError:
        return ["no slender body has contrast with the ground in this picture: more light, or a plainer ground"]
    words = []
    u, v = seen.base_px
    off = np.array(seen.base_px) - geometry.base
    tip_off = np.array(seen.tip_px) - geometry.base
    if min(np.linalg.norm(off), np.linalg.norm(tip_off)) > ANOTHER_PLACE * geometry.length:
        words.append(
            f"the slender body in view begins at base_px = [{u:.0f}, {v:.0f}] or"
            f" [{seen.tip_px[0]:.0f}, {seen.tip_px[1]:.0f}], declared [{geometry.base[0]:.0f}, {geometry.base[1]:.0f}]"
        )
    if abs(seen.length_px / geometry.length - 1.0) > ANOTHER_SCALE:
        words.append(
            f"it is {seen.length_px:.0f} px long, declared {geometry.length:.0f} px: check m_per_px and length_m,"
            " or a part of it is hidden"
        )
    if servo and np.arccos(np.clip(np.array(seen.arm_px) @ geometry.arm, -1.0, 1.0)) > TURNED:
        words.append(f"it points along arm_px = [{seen.arm_px[0]:.2f}, {seen.arm_px[1]:.2f}]")
    return words


class Watch:
    """Reports once, early, that tracking is slow or loses most of its frames."""

    def __init__(self) -> None:
        self._began: float | None = None
        self._frames, self._lost, self._said = 0, 0, False

    def look(self, now: float, reason: str) -> str:
        """The report, or "": at now [s] on any clock, after a frame with that reason of rejection.

        Time counts from the first frame, because before it the code is compiled once.
        """
        if self._began is None:
            self._began = now
        if reason == "repeats the frame before":
            return ""
        self._frames += 1
        self._lost += bool(reason)
        taken = now - self._began
        due = self._frames >= WATCHED or taken > LATE
        if self._said or not due:
            return ""
        if self._lost > LOST * self._frames:
            self._said = True
            return f"{self._lost} of the first {self._frames} frames are lost ({reason or 'the last one is not'})"
        if taken > SLOW * self._frames:
            self._said = True
            return f"slow: {taken / self._frames:.1f} s a frame"
        return ""
