"""A proposal of where the arm is in a film, the camera that follows from it, and a picture that shows it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from tentacle.recording import Camera
from tentacle.signals import Array
from vision.frames import Grey

# rad: an arm whose mean direction lies so near to the picture's own axis hangs along it. A camera on a tripod is level
# to about a degree; in the first 90 pictures of five level films the mean of the arm was .5 to 4.7 degrees off.
LEVEL = 0.1
RANGE = 1.0  # of the swing to either side of its mean: an axis within it is the rest, because few swings tell a mean


@dataclass(frozen=True)
class ArmProposal:
    """base_px, tip_px (u, v); arm_px: unit vector along the mean arm; width_px: full width at base and tip; length_px.

    polarity: +1 an arm darker than its ground, -1 lighter. score: share of the pictures in which it was found. axis_px
    (P, 2): the midline, base to tip, in the film's picture of number `frame`, the first that shows the whole arm alone;
    tip_px is its tip. words: what a person should check. swing [rad]: half the range of the arm's directions.
    doubts: why it may be another body than the arm.
    """

    base_px: tuple[float, float]
    tip_px: tuple[float, float]
    arm_px: tuple[float, float]
    width_px: tuple[float, float]
    length_px: float
    polarity: float
    score: float
    axis_px: Array
    words: tuple[str, ...] = ()
    swing: float = 0.0
    frame: int = 0
    doubts: tuple[str, ...] = ()

    def camera(self, length: float, fps: float, exposure: float = 0.0) -> Camera:
        """The camera for an arm of that length [m], measured from the base to the tip of the silicone."""
        return Camera(fps, length / self.length_px, self.base_px, self.level_arm_px(), exposure)

    def level_arm_px(self) -> tuple[float, float]:
        """The straight arm's direction if the camera stands level: the picture's axis where the mean arm is near it."""
        axis = self.nearest_axis_px()
        near = np.hypot(self.arm_px[0] - axis[0], self.arm_px[1] - axis[1]) < max(LEVEL, RANGE * self.swing)
        return axis if near else self.arm_px

    def nearest_axis_px(self) -> tuple[float, float]:
        """The picture's axis that is nearest to the mean arm."""
        u, v = self.arm_px
        return (float(np.copysign(1.0, u)), 0.0) if abs(u) > abs(v) else (0.0, float(np.copysign(1.0, v)))

    def straight_tip_px(self) -> tuple[float, float]:
        """Where the tip is when the arm hangs straight."""
        u, v = np.array(self.base_px) + self.length_px * np.array(self.level_arm_px())
        return (float(u), float(v))

    def enlarged(self, times: int) -> ArmProposal:
        """The same proposal in pictures that are so many times as large."""
        if times == 1:
            return self
        base, tip, axis = ((np.array(place) + 0.5) * times - 0.5 for place in (self.base_px, self.tip_px, self.axis_px))
        return replace(
            self,
            base_px=(float(base[0]), float(base[1])),
            tip_px=(float(tip[0]), float(tip[1])),
            width_px=(times * self.width_px[0], times * self.width_px[1]),
            length_px=times * self.length_px,
            axis_px=axis,
        )


def picture(image: Grey, proposal: ArmProposal) -> NDArray[np.uint8]:
    """An RGB picture (H, W, 3) with base, midline and tip, at least 640 px wide, for confirmation."""
    grow = max(round(640 / image.shape[1]), 1)
    shown = cv2.resize(image, None, fx=grow, fy=grow, interpolation=cv2.INTER_NEAREST)
    shown = np.repeat(shown[:, :, None], 3, axis=2)
    place = np.rint((proposal.axis_px + 0.5) * grow - 0.5).astype(np.int32)
    cv2.polylines(shown, [place.reshape(-1, 1, 2)], False, (60, 220, 90), max(grow // 2, 1), cv2.LINE_AA)
    wide = 0.5 * proposal.width_px[0] * np.array([proposal.arm_px[1], -proposal.arm_px[0]])
    base = np.array(proposal.base_px)
    ends = [np.rint((base + sign * wide + 0.5) * grow - 0.5).astype(int).tolist() for sign in (1.0, -1.0)]
    cv2.line(shown, ends[0], ends[1], (235, 70, 60), max(grow // 2, 2), cv2.LINE_AA)
    for name, at in (("base", place[0]), ("tip", place[-1])):
        cv2.circle(shown, at.tolist(), 4, (235, 70, 60), 1, cv2.LINE_AA)
        cv2.putText(
            shown, name, (at + np.array([8, 4])).tolist(), cv2.FONT_HERSHEY_SIMPLEX, 0.5, (235, 70, 60), 1, cv2.LINE_AA
        )
    return np.asarray(shown, dtype=np.uint8)
