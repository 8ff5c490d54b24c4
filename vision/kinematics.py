"""The fit's forward model: polynomial curvature (eq. 1-3, any order) to outline points, with derivatives.

Parameters of a frame: x = [base angle offset, q1 .. qn] [rad], phi(s) = theta + x0 + sum_j q_j s^j / j.
Parameters of the recording: g = [base u, base v (px), length (relative), radius c0, c1, c2 (px)]: the radius in the
picture is the declared one plus c0 + c1 s + c2 s^2. All g are zero where the declaration is exact.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tentacle.compiled import njit
from tentacle.recording import Camera
from tentacle.signals import Array
from tentacle.specimen import Specimen
from vision.lens import Lens

SHARED = 6  # number of the recording's parameters g
FLAT = 0.5  # px, half of the flat part of a rounded tip: less is none
CORNER_PIXELS = 3.0  # px next to the arm's ends in which a side profile contains the corner


@dataclass(frozen=True)
class Geometry:
    """The declared arm in the picture: base (2,), length, radius (S + 1,) [px]; normal, arm (2,) unit vectors.

    rounding [px]: radius of the rounded tip, which the radius contains; 0 for a flat cut.
    """

    base: Array
    normal: Array
    arm: Array
    length: float
    radius: Array
    lens: Lens
    rounding: float = 0.0

    @staticmethod
    def declared(specimen: Specimen, camera: Camera, lens: Lens | None = None) -> Geometry:
        """The geometry from the declaration; one station per px of length, 80 to 1200."""
        arm = np.array(camera.arm_px, dtype=float)
        length = specimen.length / camera.metres_per_px
        s = np.linspace(0.0, 1.0, int(np.clip(length, 80, 1200)) + 1)
        return Geometry(
            base=np.array(camera.base_px, dtype=float),
            normal=np.array(camera.normal_px, dtype=float) / np.linalg.norm(arm),
            arm=arm / np.linalg.norm(arm),
            length=length,
            radius=specimen.seen_half_thickness(s) / camera.metres_per_px,
            lens=lens or Lens(),
            rounding=(specimen.tip_rounding or 0.0) / camera.metres_per_px,
        )

    def radius_at(self, shared: Array) -> Array:
        """Radius (S + 1,) [px] with the recording's correction; never under 0.3 px."""
        return _corrected(self.radius, shared)

    def heading(self, phi: float) -> Array:
        """Unit vector (2,) in the picture along the arm where its angle is phi [rad]."""
        return np.asarray(np.cos(phi) * self.arm - np.sin(phi) * self.normal, dtype=float)

    def midline(self, theta: float, x: Array, shared: Array) -> tuple[Array, Array]:
        """Centre points (S + 1, 2) [px] of the ideal picture, and angles phi (S + 1,) [rad]."""
        centre, phi, _ = _midline(self, theta, x, shared)
        return centre, phi


@dataclass(frozen=True)
class Outline:
    """Where edges are expected: points (E, 2) [px], outward unit normals (E, 2), depth (E,) [px] to the opposite edge.

    jacobian (E, K + G): how far the edge moves along its normal per unit of x and of g. s (E,) and kind (E,): 0 and 1
    are the two sides, 2 the tip's end, 3 the base's end. bulge (E,) [1/px]: curvature of the edge, outward positive.
    span (E,) [px]: how far along the edge it stands for, to either side.
    """

    points: Array
    normals: Array
    depth: Array
    jacobian: Array
    s: Array
    kind: Array
    bulge: Array
    span: Array


def _midline(geometry: Geometry, theta: float, x: Array, shared: Array) -> tuple[Array, Array, Array]:
    base = geometry.base + shared[:2]
    length = geometry.length * (1.0 + shared[2])
    stations = len(geometry.radius) - 1
    return _integrate(base, (geometry.normal, geometry.arm), length, theta, np.asarray(x, dtype=float), stations)


@njit(cache=True)
def _corrected(radius: Array, shared: Array) -> Array:
    corrected = np.empty(len(radius))
    for i in range(len(radius)):
        s = i / (len(radius) - 1)
        corrected[i] = max(radius[i] + shared[3] + s * (shared[4] + s * shared[5]), 0.3)
    return corrected


@njit(cache=True)
def _integrate(
    base: Array, axes: tuple[Array, Array], length: float, theta: float, x: Array, stations: int
) -> tuple[Array, Array, Array]:
    """Centre (S + 1, 2), phi (S + 1,) and dcentre/dx (S + 1, K, 2), by Simpson's rule between stations (eq. 3)."""
    normal, arm = axes
    order = x.shape[0]
    centre = np.empty((stations + 1, 2))
    phi = np.empty(stations + 1)
    slope = np.zeros((stations + 1, order, 2))
    basis = np.empty((3, order))
    step = 1.0 / stations
    centre[0] = base
    sines, cosines = np.empty(3), np.empty(3)
    for i in range(stations + 1):
        for part in range(3):  # part 2 is this station, 1 the half way from the last, 0 the last station
            if part == 0 and i > 0:
                sines[0], cosines[0] = sines[2], cosines[2]
                for k in range(order):
                    basis[0, k] = basis[2, k]
                continue
            s = step * (i - 0.5 * (2 - part))
            angle, power = theta + x[0], 1.0
            basis[part, 0] = 1.0
            for k in range(1, order):
                power *= s
                basis[part, k] = power / k
                angle += x[k] * basis[part, k]
            sines[part], cosines[part] = np.sin(angle), np.cos(angle)
            if part == 2:
                phi[i] = angle
        if i == 0:
            continue
        for axis in range(2):
            centre[i, axis] = centre[i - 1, axis]
            for k in range(order):
                slope[i, k, axis] = slope[i - 1, k, axis]
        for part in range(3):
            weight = length * step * (4.0 if part == 1 else 1.0) / 6.0
            for axis in range(2):
                tangent = -sines[part] * normal[axis] + cosines[part] * arm[axis]
                side = cosines[part] * normal[axis] + sines[part] * arm[axis]
                centre[i, axis] += weight * tangent
                for k in range(order):
                    slope[i, k, axis] -= weight * side * basis[part, k]
    return centre, phi, slope


def outline(geometry: Geometry, theta: float, x: Array, shared: Array, stride: int = 1) -> Outline:
    """The edges to look for, every stride-th station of both sides, then the tip's end and the base's end."""
    x = np.asarray(x, dtype=float)
    course = _midline(geometry, theta, x, shared)
    relative = 1.0 + shared[2]
    radius, axes = geometry.radius_at(shared), (geometry.normal, geometry.arm)
    length = geometry.length * relative
    edges = Outline(*_edges(course, radius, axes, (length, relative), x, stride))
    if geometry.rounding > 0.0:
        edges.bulge[_on_cap(geometry, edges, length, float(radius[-1]))] += 1.0 / geometry.rounding
    return edges


def _on_cap(geometry: Geometry, edges: Outline, length: float, flat: float) -> NDArray[np.bool_]:
    """Edges (E,) on the rounded tip: sides beside it, and its end if there the flat part (half of it [px]) is small."""
    return np.where(edges.kind < 2, length * (1.0 - edges.s) < geometry.rounding, (edges.kind == 2) & (flat < FLAT))


@njit(cache=True)
def _edges(
    course: tuple[Array, Array, Array],
    radius: Array,
    axes: tuple[Array, Array],
    sizes: tuple[float, float],
    x: Array,
    stride: int,
) -> tuple[Array, Array, Array, Array, Array, Array, Array, Array]:
    """An Outline's fields; course as of _integrate, axes: normal and arm, sizes: length [px], and over the declared."""
    centre, phi, slope = course
    normal, arm = axes
    length, relative = sizes
    stations, order = phi.shape[0] - 1, x.shape[0]
    first = int(np.ceil(max(CORNER_PIXELS / length, 0.02) * stations))
    last = int(np.floor((1.0 - CORNER_PIXELS / length) * stations))
    rows = (last - first) // stride + 1
    tip_rows = max(int(radius[stations] / stride), 1)
    base_rows = max(int(radius[0] / stride), 1)
    count = 2 * rows + tip_rows + base_rows
    points, normals = np.empty((count, 2)), np.empty((count, 2))
    depth, at, kind, bulge, span = np.empty(count), np.empty(count), np.empty(count), np.zeros(count), np.empty(count)
    jacobian = np.zeros((count, order + SHARED))
    for e in range(count):
        if e < 2 * rows:  # the sides: centre + sigma radius N (eq. 4)
            kind[e] = e // rows
            i = first + stride * (e % rows)
            offset = radius[i] * (1.0 if kind[e] == 0 else -1.0)
        elif e < 2 * rows + tip_rows:
            kind[e], i = 2, stations
            offset = radius[i] * 0.5 * (2.0 * (e - 2 * rows + 0.5) / tip_rows - 1.0)
        else:
            kind[e], i = 3, 0
            offset = radius[i] * 0.5 * (2.0 * (e - 2 * rows - tip_rows + 0.5) / base_rows - 1.0)
        s = i / stations
        sine, cosine = np.sin(phi[i]), np.cos(phi[i])
        n_u, n_v = cosine * normal[0] + sine * arm[0], cosine * normal[1] + sine * arm[1]
        t_u, t_v = -sine * normal[0] + cosine * arm[0], -sine * normal[1] + cosine * arm[1]
        points[e, 0], points[e, 1] = centre[i, 0] + offset * n_u, centre[i, 1] + offset * n_v
        if kind[e] < 2:  # outward and across the edge, which the taper tilts against N
            side = 1.0 if kind[e] == 0 else -1.0
            curvature, power = 0.0, 1.0
            for k in range(1, order):
                curvature += x[k] * power
                power *= s
            low, high = max(i - 1, 0), min(i + 1, stations)
            taper = (radius[high] - radius[low]) / (high - low) * stations
            along, across = -taper, side * (length + offset * curvature)
            m_u, m_v = across * n_u + along * t_u, across * n_v + along * t_v
            depth[e] = 2.0 * radius[i]
            bulge[e] = side * curvature / (length + offset * curvature)
            span[e] = 0.5 * stride * np.hypot(across, along) / stations
        else:
            sign = 1.0 if kind[e] == 2 else -1.0
            m_u, m_v = sign * t_u, sign * t_v
            depth[e] = 0.5 * length
            span[e] = 0.5 * radius[i] / (tip_rows if kind[e] == 2 else base_rows)
        size = np.hypot(m_u, m_v)
        m_u, m_v = m_u / size, m_v / size
        normals[e, 0], normals[e, 1] = m_u, m_v
        at[e] = s
        turn = offset * (t_u * m_u + t_v * m_v)  # dN/dphi = T
        for k in range(order):
            basis = 1.0 if k == 0 else s**k / k
            jacobian[e, k] = slope[i, k, 0] * m_u + slope[i, k, 1] * m_v + turn * basis
        jacobian[e, order] = m_u
        jacobian[e, order + 1] = m_v
        reach_u, reach_v = centre[i, 0] - centre[0, 0], centre[i, 1] - centre[0, 1]
        jacobian[e, order + 2] = (reach_u * m_u + reach_v * m_v) / relative
        if kind[e] < 2:
            side = 1.0 if kind[e] == 0 else -1.0
            grow = side * (n_u * m_u + n_v * m_v)
            jacobian[e, order + 3] = grow
            jacobian[e, order + 4] = grow * s
            jacobian[e, order + 5] = grow * s * s
    return points, normals, depth, jacobian, at, kind, bulge, span
