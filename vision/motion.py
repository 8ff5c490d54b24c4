"""Effect of the arm's motion on its edges while the shutter is open: width of the smear, and shift of its middle.

To first order an edge is smeared evenly to both sides of where it is at mid exposure. To second order its mean place
shifts, because a bent arm turns as it moves along itself, and accelerates. In a tank at 4 ms the shift is about 0.01
px, three times the error of a shape from all edges of an arm. Therefore the outline is computed at two instants beside
the middle (Gauss's two points, exact to the third order in time), and intersected with each profile.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tentacle.compiled import njit
from tentacle.signals import Array
from vision.kinematics import Geometry, Outline, outline

GAUSS = 0.5 / np.sqrt(3.0)  # of the exposure, from its middle


@dataclass(frozen=True)
class ShapeMotion:
    """An arm's shapes x (K,) [rad] at up to two other times [s], the motor's angle added to their first entry."""

    known: tuple[tuple[float, Array], ...] = ()

    def at(self, t: float, x: Array) -> tuple[Array, Array]:
        """Speed and acceleration (K,) at time t with shape x, from the parabola or the line through all shapes."""
        chords = [((x - other) / (t - when), t - when) for when, other in self.known if when != t]
        if not chords:
            return np.zeros(len(x)), np.zeros(len(x))
        if len(chords) == 1 or chords[0][1] == chords[1][1]:
            return chords[0][0], np.zeros(len(x))
        (near, near_gap), (far, far_gap) = chords
        half = (near - far) / (far_gap - near_gap)  # half the acceleration: chord = speed - half gap
        return near + half * near_gap, 2.0 * half


@dataclass(frozen=True)
class Sweep:
    """Motion of each edge (E,) during an exposure [px]: width of the smear across the edge, outward shift of the mean
    place from that at mid exposure, and slip, the motion along the edge.
    """

    width: Array
    shift: Array
    slip: Array


def sweep(
    geometry: Geometry, total: Array, shared: Array, expected: Outline, rates: tuple[Array, Array], span: float
) -> Sweep:
    """The edges' motion over an exposure of span [s] about the shape total (K,), the motor's angle in its first entry.

    rates: speed and acceleration (K,) [rad/s, rad/s^2], see Motion.at. expected: the outline of that shape.
    """
    speed, acceleration = rates
    if span == 0.0 or not speed.any():
        still = np.zeros(len(expected.s))
        return Sweep(still, still, still)
    apart = GAUSS * span
    crossings, slips = [], []
    for time in (apart, -apart):
        then = outline(geometry, 0.0, total + speed * time + 0.5 * acceleration * time**2, shared)
        crossing, slip = _crossings(expected.points, expected.normals, expected.bulge, then.points, then.normals)
        crossings.append(crossing)
        slips.append(slip)
    wide = 0.5 / GAUSS  # from between the two instants to the whole exposure
    return Sweep(
        width=wide * np.abs(crossings[0] - crossings[1]),
        shift=0.5 * (crossings[0] + crossings[1]),
        slip=wide * np.abs(slips[0] - slips[1]),
    )


@njit(cache=True, nogil=True)
def _crossings(points: Array, normals: Array, bulge: Array, then: Array, turned: Array) -> tuple[Array, Array]:
    """Intersection of a moved edge with each profile (E,) [px outward], and the motion of its own point along the edge.
    then, turned (E, 2): the moved edge's points and normals; beside its point the edge deviates from the tangent by
    bulge / 2 times the distance squared.
    """
    count = len(bulge)
    crossing, slip = np.empty(count), np.empty(count)
    for e in range(count):
        n_u, n_v = normals[e, 0], normals[e, 1]
        m_u, m_v = turned[e, 0], turned[e, 1]
        du, dv = then[e, 0] - points[e, 0], then[e, 1] - points[e, 1]
        slip[e] = dv * n_u - du * n_v
        crossing[e] = (du * m_u + dv * m_v - 0.5 * bulge[e] * slip[e] ** 2) / (n_u * m_u + n_v * m_v)
    return crossing, slip
