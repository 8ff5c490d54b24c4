"""The visible length of an arm, along its fitted course and beyond it along possible arcs of the tip.

The sides hardly determine the length, because the coordinates of a curve can be counted from any point; the tip
determines it. Several arcs leave the fitted course shortly before its end. The arc with the largest sum (contrast /
usual - HALF) ds is taken, and the arm ends where this sum is largest. The usual contrast of the arm's middle comes from
the stretch before: in a body that lets light through the middle is fainter than the edges.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

from tentacle.signals import Array
from vision.edge_look import EdgeLook
from vision.edges import grey_at
from vision.kinematics import Geometry

FROM, AHEAD, STEPS = 0.82, 0.4, 40  # start of the search, its length beyond the end (of the arm), steps
HEADINGS = np.linspace(-0.3, 0.3, 5)  # rad by which an arc may leave the fitted course
BENDS = np.linspace(-6.0, 6.0, 17)  # rad per arm's length: the arcs' curvature
BORDER = 4  # steps beyond the end that must be in the picture
BEFORE, LEAST_BEFORE = 0.15, 0.5  # of the arm: stretch that shows the usual contrast of the middle; its least share
HALF = 0.45  # of the usual contrast: less counts as ground
MARGIN = 4.0  # px beyond the sides: place of the ground's grey
# Of the length: half the distance of neighbouring arcs at the declared end. The ground's grey is read at least so far
# beyond the sides; nearer, it would be the arm's own where the arm lies between two arcs.
BETWEEN_ARCS = 0.25 * float(np.diff(BENDS)[0]) * (1.0 - FROM) ** 2


class SeenEnd(NamedTuple):
    """Where an arm is seen to end: the share of its length, and the distance [px] of the fitted course there; both NaN
    if the picture's border is too near. turn [rad] at the begin and bend [rad per length] of the arc that leads there.
    """

    share: float
    off: float
    turn: float = 0.0
    bend: float = 0.0


def led_to_end(x: Array, seen: SeenEnd) -> Array:
    """The shape x (K,) [rad] with its own headings up to FROM and from there those of the arc to the seen end.

    By least squares on the headings, x0 + sum_k x_k s^k / k.
    """
    s = np.linspace(0.0, max(seen.share, FROM), 60)
    powers = np.array([np.ones(len(s)), *(s**k / k for k in range(1, len(x)))]).T
    headings, at = powers @ x, float(x[0] + sum(x[k] * FROM**k / k for k in range(1, len(x))))
    led = np.where(s > FROM, at + seen.turn + seen.bend * (s - FROM), headings)
    return np.asarray(np.linalg.lstsq(powers, led, rcond=None)[0], dtype=float)


def seen_reach(
    image: NDArray[np.uint8],
    geometry: Geometry,
    course: tuple[Array, Array],
    shared: Array,
    sight: EdgeLook,
    begin_at: float = FROM,
) -> SeenEnd:
    """Where an arm is seen to end; the search begins at the share begin_at of its length.

    course: the fitted centre points (S + 1, 2) [px] and headings (S + 1,) [rad].
    """
    centre, phi = course
    length = geometry.length * (1.0 + shared[2])
    begin = round(begin_at * (len(centre) - 1))
    ahead = (np.arange(STEPS) + 0.5) * AHEAD / STEPS
    turn, bend = (grid.ravel()[:, None] for grid in np.meshgrid(HEADINGS, BENDS))
    heading = phi[begin] + turn + bend * ahead  # (arcs, STEPS)
    along = np.cos(heading)[..., None] * geometry.arm - np.sin(heading)[..., None] * geometry.normal
    step = length * AHEAD / STEPS
    middle = centre[begin] + step * (np.cumsum(along, axis=1) - 0.5 * along)
    s = begin_at + ahead
    probe = Probe(image, geometry, shared, sight)
    back = np.unique(np.round((begin_at - BEFORE * np.linspace(0.0, 1.0, 16)) * (len(centre) - 1)).astype(int))
    before = probe.contrast(centre[back], phi[back], back / (len(centre) - 1.0))
    usually = float(np.clip(np.nanmedian(before), LEAST_BEFORE, 1.0)) if np.isfinite(before).any() else 1.0
    seen = probe.contrast(middle, heading, s) / usually
    gathered = np.cumsum(np.clip(seen, -1.0, 1.0) - HALF, axis=1)
    most = np.nan_to_num(gathered, nan=-1.0).max(axis=1)
    best = int(np.argmax(most))
    if most[best] <= 0.0:  # nothing is seen beyond the begin, or the arcs leave the picture there
        left = not np.isfinite(gathered[:, BORDER]).all()
        return SeenEnd(np.nan, np.nan) if left else SeenEnd(begin_at, 0.0)
    end = int(np.nanargmax(gathered[best]))
    if end + BORDER >= STEPS or not np.isfinite(gathered[best, end + BORDER]):
        return SeenEnd(np.nan, np.nan)
    inside = min(end, int(np.searchsorted(s, 1.0)) - 1)
    off = float(np.linalg.norm(centre[begin:] - middle[best, inside], axis=1).min())
    return SeenEnd(float(s[end] + 0.5 * step / length), off, float(turn[best, 0]), float(bend[best, 0]))


@dataclass(frozen=True)
class Probe:
    """A picture in which the middle of an arm is compared with the ground on both sides."""

    image: NDArray[np.uint8]
    geometry: Geometry
    shared: Array
    sight: EdgeLook

    def contrast(self, middle: Array, heading: Array, s: Array) -> Array:
        """Contrast (..., N) of the weaker side at points middle (..., N, 2) [px], over the usual one at s (N,).

        heading (..., N) [rad]. NaN outside the picture.
        """
        radii = self.geometry.radius_at(self.shared)
        radius = np.interp(np.minimum(s, 1.0), np.linspace(0.0, 1.0, len(radii)), radii)
        across = np.cos(heading)[..., None] * self.geometry.normal + np.sin(heading)[..., None] * self.geometry.arm
        beside = (radius + max(MARGIN, BETWEEN_ARCS * self.geometry.length))[:, None] * across
        probes = np.stack([middle, middle + beside, middle - beside])
        points = np.ascontiguousarray(probes.reshape(-1, 2))
        grey = grey_at(self.image, self.geometry.lens.packed, points).reshape(probes.shape[:-1])
        weaker = np.minimum(self.sight.polarity * (grey[1] - grey[0]), self.sight.polarity * (grey[2] - grey[0]))
        usual = self.sight.contrast_at(np.minimum(s, 1.0)) * erf(radius / (np.sqrt(2.0) * self.sight.blur))
        return np.asarray(weaker / usual)
