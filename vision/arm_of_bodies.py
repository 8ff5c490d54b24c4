"""The arm in a film's bodies: which end is the base, and what is cut off there.

The base is the end that does not move. A part there that is wider than the arm's taper is cut off: a clamp at its
corners, a fish's trunk where motion begins. A base that is known says both.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from tentacle.signals import Array
from vision.arm_proposal import ArmProposal
from vision.body_axis import axis_between, base_opposite, clamped_until, widths_along
from vision.candidates import SlenderBody, reversed_axis
from vision.hinge import motion_begins
from vision.shoulders import from_shoulders
from vision.silhouette import Axis

MOSTLY = 0.5  # share of the pictures in which a wider part without corners holds the arm
ALIKE = 0.05  # of the length: a contour's ends are found to about 2 %
RIM = 2.0  # px from the picture's border: a tip there is out of view
STILL = 2.0  # px: a tip that moves less does not tell the base from the tip


class _Cut(NamedTuple):
    """Each picture's axis, the index of the first point that is the arm's, its midline (P, 2), and what is doubtful."""

    axes: list[Axis]
    held: list[int]
    lines: list[Array]
    words: str = ""


def proposal_of(
    bodies: Sequence[SlenderBody | None], shape: Sequence[int], polarity: float, base: Array | None = None
) -> ArmProposal | None:
    """The arm in one body a picture, of pictures of that shape; None if no body has an axis. base (2,) [px] where it
    is known. The proposal's frame counts these pictures.
    """
    there = [(k, body) for k, body in enumerate(bodies) if body is not None]
    if not there:
        return None
    first = [body.axis for _, body in there]
    first = _base_first(first, shape) if base is None else [_from_base(axis, base) for axis in first]
    tips = [axis.points[-1] for axis in first]
    # a flat end's two corners bend most: the middle of the base is half the perimeter from the tip
    ends = [base_opposite(body.contour, tip) for (_, body), tip in zip(there, tips, strict=True)]
    whole = [axis_between(body.contour, *pair) for (_, body), pair in zip(there, ends, strict=True)]
    seen = [(k, body.contour, axis) for (k, body), axis in zip(there, whole, strict=True) if axis is not None]
    if not seen:
        return None
    found = [axis for _, _, axis in seen]
    cut = _cut([contour for _, contour, _ in seen], found) if base is None else _cut_at(found, base)
    arm, swing = _direction(cut.lines)
    alone = _alone(cut.lines, cut.held, shape)
    found, held, lines = [cut.axes[k] for k in alone], [cut.held[k] for k in alone], [cut.lines[k] for k in alone]
    at = np.median([line[0] for line in lines], axis=0)
    widths = np.median([_ends_width(axis, first) for axis, first in zip(found, held, strict=True)], axis=0)
    words = [cut.words] if cut.words and max(held) > 0 else []
    if base is None and len(bodies) > 1 and np.ptp(np.array(tips), axis=0).max() < STILL:
        words.append("nothing moves: base and tip may be exchanged")
    return ArmProposal(
        base_px=(float(at[0]), float(at[1])),
        tip_px=(float(lines[0][-1][0]), float(lines[0][-1][1])),
        arm_px=(float(arm[0]), float(arm[1])),
        width_px=(float(widths[0]), float(widths[1])),
        length_px=float(np.median([_length(line) for line in lines])),
        polarity=polarity,
        score=len(seen) / len(bodies),
        axis_px=lines[0],
        words=tuple(words),
        swing=swing,
        frame=seen[alone[0]][0],
    )


def _cut(contours: Sequence[Array], axes: list[Axis]) -> _Cut:
    """The axes without what holds the arm."""
    held = [clamped_until(axis) for axis in axes]
    cut = [
        from_shoulders(contour, axis, first) if first else None
        for contour, axis, first in zip(contours, axes, held, strict=True)
    ]
    words, hinge = "the base is where the arm gets wider than its taper: is this where it is held?", None
    if np.mean([first > 0 and line is None for first, line in zip(held, cut, strict=True)]) > MOSTLY:
        hinge = motion_begins([axis.points for axis in axes])
    if hinge is not None:
        cut, held = [None] * len(axes), [_index_at(axis, hinge) for axis in axes]
        words = "the base is where the body begins to move: is this where it is held?"
    lines = [axis.points[first:] if line is None else line for axis, first, line in zip(axes, held, cut, strict=True)]
    return _Cut(axes, held, lines, words)


def _from_base(axis: Axis, base: Array) -> Axis:
    """The axis from the end that is nearer along it to a known base."""
    return reversed_axis(axis) if _nearest(axis, base) > len(axis.points) // 2 else axis


def _nearest(axis: Axis, base: Array) -> int:
    return int(np.argmin(np.linalg.norm(axis.points - base, axis=1)))


def _cut_at(axes: list[Axis], base: Array) -> _Cut:
    """The axes from a known base on."""
    held = [min(_nearest(axis, base), len(axis.points) - 2) for axis in axes]
    lines = [np.concatenate([base[None], axis.points[first + 1 :]]) for axis, first in zip(axes, held, strict=True)]
    return _Cut(axes, held, lines)


def _base_first(axes: list[Axis], shape: Sequence[int]) -> list[Axis]:
    """Axes that begin at the base: the end that moves less or, if neither moves, the wider end."""
    points = [axes[0].points]
    for axis in axes[1:]:
        same = np.linalg.norm(axis.points - points[-1], axis=1).mean()
        points.append(
            axis.points if same <= np.linalg.norm(axis.points[::-1] - points[-1], axis=1).mean() else axis.points[::-1]
        )
    exchanged = [p is not axis.points for p, axis in zip(points, axes, strict=True)]
    axes = [reversed_axis(axis) if turn else axis for axis, turn in zip(axes, exchanged, strict=True)]
    ends = np.array([[axis.points[0], axis.points[-1]] for axis in axes])
    moves = np.linalg.norm(np.std(ends, axis=0), axis=1)
    if max(moves) > 2.0 * min(moves) + 1.0:
        exchange = moves[0] > moves[1]
    else:
        size = np.array(shape[::-1], dtype=float)
        rim = np.min(np.concatenate([ends, size - 1.0 - ends], axis=2), axis=2).mean(axis=0)
        wide = [np.median([np.mean(axis.width[part]) for axis in axes]) for part in (slice(0, 60), slice(-60, None))]
        exchange = rim[1] < rim[0] - 5.0 if abs(wide[0] - wide[1]) < 0.15 * sum(wide) else wide[1] > wide[0]
    return [reversed_axis(axis) for axis in axes] if exchange else axes


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
