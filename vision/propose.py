"""Finds an arm in a film without other knowledge: base, tip, widths and length in px, to be confirmed by a person.

The arm is the slender body that has contrast with its smooth ground and moves. Its base is the end that does not move;
there a part that is wider than the arm's taper is cut off: a clamp at its corners, a fish's trunk where motion begins.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from tentacle.errors import InputError
from tentacle.recording import Camera
from tentacle.signals import Array
from vision.body_axis import axis_between, base_opposite, clamped_until, widths_along
from vision.candidates import arms, turned
from vision.frames import Grey, read_frames
from vision.hinge import motion_begins
from vision.shoulders import from_shoulders
from vision.silhouette import Axis

LOOKED_AT, EVERY = 15, 6  # pictures of a film, and how many apart
MOSTLY = 0.5  # share of the pictures in which a wider part without corners holds the arm
ALIKE = 0.05  # of the length: a contour's ends are found to about 2 %
# rad: an arm whose mean direction lies so near to the picture's own axis hangs along it. A camera on a tripod is level
# to about a degree; in the first 90 pictures of five level films the mean of the arm was .5 to 4.7 degrees off.
LEVEL = 0.1
RANGE = 1.0  # of the swing to either side of its mean: an axis within it is the rest, because few swings tell a mean
RIM = 2.0  # px from the picture's border: a tip there is out of view


@dataclass(frozen=True)
class ArmProposal:
    """base_px, tip_px (u, v); arm_px: unit vector along the mean arm; width_px: full width at base and tip; length_px.

    polarity: +1 an arm darker than its ground, -1 lighter. score: share of the pictures in which it was found. axis_px
    (P, 2): the midline, base to tip, in the film's picture of number `frame`, the first that shows the whole arm alone;
    tip_px is its tip. words: what a person should check. swing [rad]: half the range of the arm's directions.
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

    def camera(self, length: float, fps: float, exposure: float = 0.0) -> Camera:
        """The camera for an arm of that length [m], measured from the base to the tip of the silicone."""
        return Camera(fps, length / self.length_px, self.base_px, self.level_arm_px(), exposure)

    def level_arm_px(self) -> tuple[float, float]:
        """The straight arm's direction if the camera stands level: the picture's axis where the mean arm is near it."""
        u, v = self.arm_px
        if abs(u) > abs(v):
            axis = (np.copysign(1.0, u), 0.0)
        else:
            axis = (0.0, np.copysign(1.0, v))
        near = np.hypot(u - axis[0], v - axis[1]) < max(LEVEL, RANGE * self.swing)
        return (float(axis[0]), float(axis[1])) if near else self.arm_px

    def straight_tip_px(self) -> tuple[float, float]:
        """Where the tip is when the arm hangs straight."""
        u, v = np.array(self.base_px) + self.length_px * np.array(self.level_arm_px())
        return (float(u), float(v))


def propose_arm(source: Path | Grey, fps: float | None = None) -> ArmProposal:
    """The arm in a film (the first pictures of a file, or of a folder at fps), or in one picture (H, W).

    Raises InputError where nothing slender stands out.
    """
    if isinstance(source, np.ndarray):
        return propose_among([source])
    frames = islice(read_frames(Path(source), fps or 30.0), LOOKED_AT * EVERY)
    try:
        return propose_among([frame.image for k, frame in enumerate(frames) if k % EVERY == 0])
    except InputError as error:
        raise error if error.file else InputError(error.problem, file=source, expected=error.expected) from error


def propose_among(pictures: Sequence[Grey]) -> ArmProposal:
    """The arm in pictures of one film."""
    if not pictures:
        raise InputError("there are no pictures", expected="a film")
    pictures = [picture for picture in pictures if picture.shape == pictures[0].shape]
    ways = [(polarity, arms(pictures, polarity)) for polarity in (1.0, -1.0)]
    polarity, bodies = max(ways, key=lambda way: sum(body.merit for body in way[1] if body is not None))
    both = [(body.contour, body.axis) for body in bodies if body is not None]
    if not both:
        raise InputError("nothing slender stands out against its ground", expected="an arm in view, or --base-px")
    tips = [axis.points[-1] for axis in _base_first([axis for _, axis in both], pictures[0].shape)]
    # a flat end's two corners bend most: the middle of the base is half the perimeter from the tip
    ends = [base_opposite(contour, tip) for (contour, _), tip in zip(both, tips, strict=True)]
    whole = [axis_between(contour, *pair) for (contour, _), pair in zip(both, ends, strict=True)]
    there = [k for k, body in enumerate(bodies) if body is not None]
    seen = [(k, both[i][0], axis) for i, (k, axis) in enumerate(zip(there, whole, strict=True)) if axis is not None]
    if not seen:
        raise InputError("nothing slender stands out against its ground", expected="an arm in view, or --base-px")
    found = [axis for _, _, axis in seen]
    held = [clamped_until(axis) for axis in found]
    cut = [
        from_shoulders(contour, axis, first) if first else None
        for (_, contour, axis), first in zip(seen, held, strict=True)
    ]
    hinge = None
    if np.mean([first > 0 and line is None for first, line in zip(held, cut, strict=True)]) > MOSTLY:
        hinge = motion_begins([axis.points for axis in found])
    if hinge is not None:
        cut, held = [None] * len(found), [_index_at(axis, hinge) for axis in found]
    lines = [axis.points[first:] if line is None else line for axis, first, line in zip(found, held, cut, strict=True)]
    arm, swing = _direction(lines)
    score, alone = len(found) / len(pictures), _alone(lines, held, pictures[0].shape)
    found, held, lines = [found[k] for k in alone], [held[k] for k in alone], [lines[k] for k in alone]
    base = np.median([line[0] for line in lines], axis=0)
    lengths = [_length(line) for line in lines]
    widths = np.median([_ends_width(axis, first) for axis, first in zip(found, held, strict=True)], axis=0)
    words = []
    if hinge is not None:
        words.append("the base is where the body begins to move: is this where it is held?")
    elif max(held) > 0:
        words.append("the base is where the arm gets wider than its taper: is this where it is held?")
    if len(pictures) > 1 and np.ptp(np.array(tips), axis=0).max() < 2.0:
        words.append("nothing moves: base and tip may be exchanged")
    return ArmProposal(
        base_px=(float(base[0]), float(base[1])),
        tip_px=(float(lines[0][-1][0]), float(lines[0][-1][1])),
        arm_px=(float(arm[0]), float(arm[1])),
        width_px=(float(widths[0]), float(widths[1])),
        length_px=float(np.median(lengths)),
        polarity=polarity,
        score=score,
        axis_px=lines[0],
        words=tuple(words),
        swing=swing,
        frame=EVERY * seen[alone[0]][0],
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


def _base_first(axes: list[Axis], shape: Sequence[int]) -> list[Axis]:
    """Axes that begin at the base: the end that moves less or, if neither moves, the wider end."""
    points = [axes[0].points]
    for axis in axes[1:]:
        same = np.linalg.norm(axis.points - points[-1], axis=1).mean()
        points.append(
            axis.points if same <= np.linalg.norm(axis.points[::-1] - points[-1], axis=1).mean() else axis.points[::-1]
        )
    exchanged = [p is not axis.points for p, axis in zip(points, axes, strict=True)]
    axes = [turned(axis) if turn else axis for axis, turn in zip(axes, exchanged, strict=True)]
    ends = np.array([[axis.points[0], axis.points[-1]] for axis in axes])
    moves = np.linalg.norm(np.std(ends, axis=0), axis=1)
    if max(moves) > 2.0 * min(moves) + 1.0:
        exchange = moves[0] > moves[1]
    else:
        size = np.array(shape[::-1], dtype=float)
        rim = np.min(np.concatenate([ends, size - 1.0 - ends], axis=2), axis=2).mean(axis=0)
        wide = [np.median([np.mean(axis.width[part]) for axis in axes]) for part in (slice(0, 60), slice(-60, None))]
        exchange = rim[1] < rim[0] - 5.0 if abs(wide[0] - wide[1]) < 0.15 * sum(wide) else wide[1] > wide[0]
    return [turned(axis) for axis in axes] if exchange else axes


def _length(line: Array) -> float:
    """Length of a line (P, 2)."""
    return float(np.sum(np.linalg.norm(np.diff(line, axis=0), axis=1)))


def _index_at(axis: Axis, arc: float) -> int:
    """Index of the first point of an axis at that arc length [px] or beyond."""
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(axis.points, axis=0), axis=1))])
    return min(int(np.searchsorted(along, arc)), len(axis.points) - 2)


def _direction(lines: Sequence[Array]) -> tuple[Array, float]:
    """Unit vector (2,) of the mean of the lines' directions, base to tip, and half the range of these [rad]."""
    ahead = np.array([line[-1] - line[0] for line in lines])
    mean = np.sum(ahead / np.linalg.norm(ahead, axis=1, keepdims=True), axis=0)
    arm = mean / max(float(np.linalg.norm(mean)), 1e-9)
    turn = np.arctan2(arm[0] * ahead[:, 1] - arm[1] * ahead[:, 0], ahead @ arm)
    return arm, 0.5 * float(np.ptp(turn))


def _alone(lines: Sequence[Array], held: Sequence[int], shape: Sequence[int]) -> list[int]:
    """The pictures in which the arm is seen best: its tip within the picture, and nothing added to it.

    An arm has one length, which most pictures agree on. Where it swings against its holder the two are one body, and
    longer by various amounts; where something hides a part of it, it is shorter. Pictures without a clamp show the
    arm's own end.
    """
    rim = [float(np.min([line[-1], np.array(shape[::-1]) - 1.0 - line[-1]])) for line in lines]
    whole = [k for k, far in enumerate(rim) if far > RIM] or list(range(len(lines)))
    lengths = np.array([_length(lines[k]) for k in whole])
    alike = np.abs(lengths[:, None] - lengths) <= ALIKE * lengths  # (with, length)
    usual = max(range(len(whole)), key=lambda k: (int(alike[:, k].sum()), -lengths[k]))
    those = [k for k, like in zip(whole, alike[:, usual], strict=True) if like]
    return [k for k in those if held[k] == 0] or those


def _ends_width(axis: Axis, first: int) -> tuple[float, float]:
    _, taper = widths_along(axis)
    return float(taper[first]), float(taper[-1])
