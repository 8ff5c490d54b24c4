"""What a law of the grammar depends on, along one recording's smoothed motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.signal import lfilter

from affine_model.arm import Arm
from affine_model.curvature import Array
from affine_model.laws import relaxed
from inference.missing_force import MOTION_STEP, SeenMotion
from inference.small_motions import SmallMotions
from tentacle.law.written_law import NUMPY, WrittenLaw


@dataclass(frozen=True)
class LawInputs:
    """One recording: its small motions, and the quantities along the arm and at the tip that a law depends on;
    stiffness k(s) (N,) [N m/rad] of the model at the nodes.
    """

    arm: Arm
    small: SmallMotions
    stiffness: Array

    @property
    def motion(self) -> SeenMotion:
        """The smoothed motion of the arm."""
        return self.small.motion

    @cached_property
    def _geometry(self) -> tuple[Array, Array, Array, Array, Array, Array]:
        """phi (T, N), levers at the nodes (T, N, 2, n) and the tip (T, 2, n), positions there, phi at the tip."""
        arm, n = self.arm, self.arm.order
        L, rule, u = arm.specimen.length, arm.rule, self.motion.u
        phi = u[:, n : n + 1] + u[:, :n] @ arm.angle_basis.T
        cos, sin = np.cos(phi), np.sin(phi)
        normal, tangent = np.stack([cos, sin], -1), np.stack([-sin, cos], -1)
        columns = arm.angle_basis
        levers = np.einsum("ik,tkx,kj->tixj", L * rule.integration, -normal, columns)
        at_tip = np.einsum("k,tkx,kj->txj", L * rule.weights, -normal, columns)
        place = np.einsum("ik,tkx->tix", L * rule.integration, tangent)
        tip = np.einsum("k,tkx->tx", L * rule.weights, tangent)
        return phi, levers, at_tip, place, tip, u[:, n] + u[:, :n] @ arm.angles_at([1.0])[0]

    @cached_property
    def along(self) -> dict[str, Array]:
        """Quantities (T, N) of a line force and of a moment; memory apart."""
        arm, n, (phi, levers, _, place, _, _) = self.arm, self.arm.order, self._geometry
        u, rate = self.motion.u, self.motion.rate
        turning = rate[:, n : n + 1] + rate[:, :n] @ arm.angle_basis.T
        velocity = np.einsum("tixj,tj->tix", levers, rate[:, :n])
        velocity += rate[:, n, None, None] * np.stack([-place[..., 1], place[..., 0]], -1)
        path, going = self._travelled
        place, velocity = place + path[:, None], velocity + going[:, None]
        c = u[:, :n] @ arm.curvature_basis.T
        c_rate = rate[:, :n] @ arm.curvature_basis.T
        return {**arm.node_quantities, **self._seen(place, phi, turning, velocity), "c": c, "c_rate": c_rate}

    @cached_property
    def at_tip(self) -> dict[str, Array]:
        """Quantities (T,) of a force at the tip."""
        n, (_, _, levers, _, tip, phi) = self.arm.order, self._geometry
        rate = self.motion.rate
        turning = rate[:, n] + rate[:, :n] @ self.arm.angles_at([1.0])[0]
        velocity = np.einsum("txj,tj->tx", levers, rate[:, :n])
        velocity += rate[:, n, None] * np.stack([-tip[:, 1], tip[:, 0]], -1)
        path, going = self._travelled
        tip, velocity = tip + path, velocity + going
        return self._seen(tip, phi, turning, velocity)

    @property
    def _travelled(self) -> tuple[Array, Array]:
        """Place and rate (T, 2) of the base; zero where it stands."""
        travel = self.motion.instant.travel
        return (travel[:, :2], travel[:, 2:4]) if travel is not None else (np.zeros((1, 2)), np.zeros((1, 2)))

    def _seen(self, place: Array, phi: Array, turning: Array, velocity: Array) -> dict[str, Array]:
        cos, sin = np.cos(phi), np.sin(phi)
        u_n = velocity[..., 0] * cos + velocity[..., 1] * sin
        u_t = velocity[..., 1] * cos - velocity[..., 0] * sin
        return {
            **{name: np.asarray(value) for name, value in self.arm.arm_quantities.items()}, "x": place[..., 0],
            "t": self.motion.t.reshape(-1, *[1] * (phi.ndim - 1)), "y": place[..., 1], "phi": phi,
            "phi_rate": turning, "u_n": u_n, "u_t": u_t, "speed": np.sqrt(u_n**2 + u_t**2 + 1e-16),
        }  # fmt: skip

    @cached_property
    def _levers(self) -> dict[str, tuple[Array, Array]]:
        """Of each component: what a unit of it at the nodes (T, N, n) and at the tip (T, n) adds to the generalised
        force, quadrature included.
        """
        phi, levers, at_tip, _, _, tip_phi = self._geometry
        along = self.arm.specimen.length * self.arm.rule.weights[:, None]

        def of(x: Array, y: Array, tip_x: Array, tip_y: Array) -> tuple[Array, Array]:
            line = along * (x[..., None] * levers[:, :, 0] + y[..., None] * levers[:, :, 1])
            return line, tip_x[:, None] * at_tip[:, 0] + tip_y[:, None] * at_tip[:, 1]

        cos, sin, tip_cos, tip_sin = np.cos(phi), np.sin(phi), np.cos(tip_phi), np.sin(tip_phi)
        one, none, tip_one, tip_none = np.ones_like(phi), 0.0 * phi, np.ones_like(tip_phi), 0.0 * tip_phi
        return {
            "force_n": of(cos, sin, tip_cos, tip_sin), "force_t": of(-sin, cos, -tip_sin, tip_cos),
            "force_x": of(one, none, tip_one, tip_none), "force_y": of(none, one, tip_none, tip_one),
        }  # fmt: skip

    def prepare(self) -> None:
        """The quantities and levers of every law are computed once."""
        _ = self.along, self.at_tip, self._levers

    def remembered(self, tau: float) -> Array:
        """The memory (T, N) of a spring in series with a dashpot of that relaxation time [s]."""
        keeps, takes = relaxed(1.0, 0.0, MOTION_STEP, tau), relaxed(0.0, 1.0, MOTION_STEP, tau)
        rate = self.along["c_rate"].copy()
        rate[0] = 0.0
        return np.asarray(lfilter([takes], [1.0, -keeps], rate, axis=0))

    def force(self, law: WrittenLaw, values: Mapping[str, float]) -> Array:
        """The law's generalised force (T, n)."""
        arm = self.arm
        x = dict(self.at_tip if law.acts == "tip" else self.along)
        if law.acts == "moment":
            x["stiffness"] = self.stiffness
            if law.relaxation is not None:
                x["memory"] = self.remembered(float(law.relaxation_time(values, NUMPY)))
        found = law.values(x, values, NUMPY)
        if law.acts == "moment":
            moment = np.broadcast_to(found["moment"], self._geometry[0].shape)
            return np.asarray(-(moment * arm.bending_weights) @ arm.curvature_basis)
        total = np.zeros((self.motion.t.size, arm.order))
        for name, size in found.items():
            line, tip = self._levers[name]
            if law.acts == "tip":
                total += np.broadcast_to(size, tip.shape[:1])[:, None] * tip
            else:
                total += np.matmul(np.broadcast_to(size, line.shape[:2])[:, None], line)[:, 0]
        return total
