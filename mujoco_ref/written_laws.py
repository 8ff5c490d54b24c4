"""Laws written in effect files, on the chain: line forces at Gauss points of the links, a force at the tip, moments at
the hinges; projected on the joints by virtual work.

A force f at p turns joint k by (p - x_k) x f. A moment m(c), conjugate to the curvature c = n angle, acts on a hinge
as it is: its angle changes by delta c / n, and a hinge stands for 1 / n of the arm (chain.sharpness, at a clamp too).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mujoco_ref.chain import Chain
from mujoco_ref.hinges import relaxed
from mujoco_ref.influence import Parameters, Record
from mujoco_ref.section_water import water_motion
from mujoco_ref.water import ALONG, WEIGHT, node_table
from tentacle.compiled import njit
from tentacle.law.in_use import laws_in_use
from tentacle.law.written_law import NUMPY, WrittenLaw
from tentacle.signals import Array

SLOPE_STEP = 1e-5  # rad: differences of a moment


@njit(cache=True)
def _water_at(points: Array, t: float, water: Any, out: Array) -> None:
    """Velocity of the undisturbed water at points (N, 2) into out (N, 2)."""
    for i in range(points.shape[0]):
        out[i, 0], out[i, 1], _, _ = water_motion(points[i, 0], points[i, 1], t, water[0])


@dataclass(frozen=True)
class LawWithValues:
    """A law with the values of its parameters."""

    law: WrittenLaw
    values: Mapping[str, float]


def acting_laws(parameters: Parameters) -> tuple[LawWithValues, ...]:
    """The laws in use that these parameters name, where a strength is not zero."""
    found = []
    for law in laws_in_use():
        given = parameters.get(law.name, {})
        values = {p.name: float(given.get(p.name, p.scan[0] if p.scan else 0.0)) for p in law.parameters}
        if any(values[p.name] != 0.0 for p in law.parameters if not p.scan):
            found.append(LawWithValues(law, values))
    return tuple(found)


@dataclass(frozen=True)
class Bending:
    """The hinges (n,): angles [rad] and rates, angles at rest; memory (laws, n) [rad] of curvature at the step's start;
    time [s]; softening of all that is elastic.
    """

    angle: Array
    rate: Array
    rest: Array
    memory: Array
    t: float
    softening: float


@dataclass(frozen=True)
class WrittenLaws:
    """What the acting laws do to one chain in its water, gravity [m/s^2]."""

    acting: tuple[LawWithValues, ...]
    chain: Chain
    water: Record
    gravity: float

    @cached_property
    def _points(self) -> tuple[NDArray[np.int64], Array, dict[str, Array]]:
        """Of the Gauss points and the tip (N + 1,): link, distance from its start; the sections' quantities."""
        nodes = node_table(self.chain)
        links, points = nodes.shape[:2]
        link: NDArray[np.int64] = np.append(np.repeat(np.arange(links), points), links - 1)
        along = np.append(nodes[:, :, ALONG].ravel(), self.chain.length[-1])
        section = self.chain.specimen.section
        s = (self.chain.start[link] + along) / self.chain.specimen.length
        own = {"s": s, "area": section.area(s), "width": section.width(s), "perimeter": section.perimeter(s)}
        return link, along, own

    @cached_property
    def _weights(self) -> Array:
        return node_table(self.chain)[:, :, WEIGHT].ravel()

    @cached_property
    def _whole(self) -> dict[str, float]:
        specimen = self.chain.specimen
        return {
            "length": specimen.length, "density": specimen.density, "fluid_density": float(self.water[0]["density"]),
            "gravity": self.gravity,
        }  # fmt: skip

    def forces(self, motion: Array, t: float) -> tuple[Array, Array]:
        """Generalised force (n + 3,) of the forces along the arm and at the tip, and their sum (2,) [N]; motion as from
        link_motion.
        """
        link, along, own = self._points
        cos, sin, rate = np.cos(motion[link, 6]), np.sin(motion[link, 6]), motion[link, 7]
        place = np.stack([motion[link, 0] - along * sin, motion[link, 1] + along * cos], axis=1)
        flow = np.empty_like(place)
        _water_at(place, t, self.water, flow)
        ux = motion[link, 2] - along * rate * cos - flow[:, 0]
        uy = motion[link, 3] - along * rate * sin - flow[:, 1]
        seen = {
            **own, **self._whole, "t": t, "x": place[:, 0], "y": place[:, 1], "phi": motion[link, 6], "phi_rate": rate,
            "u_n": ux * cos + uy * sin, "u_t": uy * cos - ux * sin, "speed": np.hypot(ux, uy),
        }  # fmt: skip
        force = np.zeros_like(place)
        for one in self.acting:
            if one.law.acts == "moment":
                continue
            found = one.law.values(seen, one.values, NUMPY)
            n, tangent, x, y = (found.get(name, 0.0) for name in ("force_n", "force_t", "force_x", "force_y"))
            per_point = np.stack([n * cos - tangent * sin + x, n * sin + tangent * cos + y], axis=1)
            if one.law.acts == "line":
                force[:-1] += self._weights[:, None] * per_point[:-1]
            else:
                force[-1] += per_point[-1]
        joints = self.chain.links + 1
        sums = np.zeros((joints, 3))
        turning = place[:, 0] * force[:, 1] - place[:, 1] * force[:, 0]
        np.add.at(sums, link, np.column_stack([force, turning]))
        beyond = np.cumsum(sums[::-1], axis=0)[::-1]
        generalised = np.zeros(joints + 2)
        generalised[:2] = beyond[0, :2]
        generalised[2:] = beyond[:, 2] - motion[:joints, 0] * beyond[:, 1] + motion[:joints, 1] * beyond[:, 0]
        return generalised, beyond[0, :2]

    def moments(self, at: Bending, step: float) -> tuple[Array, Array]:
        """Moments (n,) [N m] at the hinges in the middle of a step, and what a change of the step's acceleration adds
        to them (n,), by a difference.
        """
        moment = self._moments(at, step)
        if step == 0.0 or all(one.law.acts != "moment" for one in self.acting):
            return moment, np.zeros_like(moment)
        moved = replace(at, angle=at.angle + SLOPE_STEP, rate=at.rate + 2.0 * SLOPE_STEP / step)
        return moment, 0.25 * step**2 * (self._moments(moved, step) - moment) / SLOPE_STEP

    def _moments(self, at: Bending, step: float) -> Array:
        n = self.chain.sharpness
        seen = {
            "s": self.chain.hinge_s, "c": n * (at.angle - at.rest), "c_rate": n * at.rate, "t": at.t,
            "stiffness": at.softening * self.chain.stiffness / n, "length": self.chain.specimen.length,
        }  # fmt: skip
        total = np.zeros(self.chain.links)
        for one, kept in zip(self.acting, self.remembered(at.memory, at.rate, 0.5 * step), strict=True):
            if one.law.acts == "moment":
                total += one.law.values({**seen, "memory": kept}, one.values, NUMPY)["moment"]
        return total

    def remembered(self, memory: Array, rate: Array, duration: float) -> Array:
        """Memory (laws, n) after `duration` [s] at these rates of the hinges: exactly memory' = c' - memory / tau."""
        after = memory.copy()
        for k, one in enumerate(self.acting):
            if one.law.relaxation is not None:
                tau = float(one.law.relaxation_time(one.values, NUMPY))
                after[k] = relaxed(memory[k], self.chain.sharpness * rate, duration, tau)
        return after
