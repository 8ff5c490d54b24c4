"""The water's forces on an exported arm, and its material's memory, as one passive callback of MuJoCo.

    model = mujoco.MjModel.from_xml_path("arm.xml")
    forces = Forces(model)              # first: it takes MuJoCo's own water out of the model
    data = mujoco.MjData(model)
    forces.attach()                     # mujoco.set_mjcb_passive; forces.detach() ends it

The numbers stand in arm.xml (<custom>), so this file is the same for every arm; it needs numpy and mujoco alone. Per
length, with u the velocity relative to the water, n the normal and t the tangent of a link:

    drag        f_n = -(1/2 rho C_perp w |u| + c_n) u_n,   f_t = -(1/2 rho C_t P |u| + c_n/2) u_t, and its options
    wall        1/2 rho w C_perp B / (2 + 10 e/D) |u| u_n more drag, and added mass that changes with the place
    added mass  m_a = C_a rho pi w^2/4 along n (a share of it along t), added to data.M before MuJoCo solves with it;
                the share `convective` of Kirchhoff's terms -m_a phi' (u_t n + u_n t), couple m_a u_n u_t

Limits: the arm's clamp turns about z and does not travel; links move in the plane; C callbacks do not exist in MJX.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mujoco as _mujoco
import numpy as np

mujoco: Any = _mujoco
SECOND_WAVE = 1.7320508075688772  # of a deep tank: frequency of its second odd standing wave over the first, sqrt(3)
VISCOSITY = 1e-6  # m^2/s, of water at 20 degrees C
WATER = (
    "density", "C_perp", "C_t", "C_a", "tangential", "convective", "c_n", "U_x", "U_y", "U_cos", "U_sin", "slosh_f",
    "V_cos", "V_sin", "wall_B", "wall_x", "wall_carried", "cross_flow", "reynolds", "oscillating",
    "oscillating_f", "shed", "lift_cos", "lift_sin", "stream",
)  # fmt: skip
NAME_PREFIX = "tentacle_"


@dataclass(frozen=True)
class _Motion:
    """Of every link: where it starts (n + 1, 2) [m], velocity there through the water, acceleration there beyond the
    water's, without qacc; rate (n + 1,) [rad/s], normal and tangent (n + 1, 2). surge (2,): the water's acceleration.
    """

    start: np.ndarray
    slip: np.ndarray
    bias: np.ndarray
    rate: np.ndarray
    normal: np.ndarray
    tangent: np.ndarray
    surge: np.ndarray


class Forces:
    """Forces of one exported arm. drag (2,): the water's force on it [N] in the base frame, without added mass."""

    def __init__(self, model: Any) -> None:
        """Read the numbers, and replace the substitutes in arm.xml by the arm's own mass, inertia and buoyancy."""
        self.model = model
        names = [model.numeric(i).name for i in range(model.nnumeric)]
        read = {
            name[len(NAME_PREFIX) :]: model.numeric(name).data.copy() for name in names if name.startswith(NAME_PREFIX)
        }
        if "length" not in read:
            raise ValueError("this model holds no numbers of an exported arm: is it arm.xml?")
        self.links = len(read["length"])
        node = {name: values.reshape(self.links, -1) for name, values in read.items() if name.startswith("node_")}
        self._n = {**read, **node}
        water = read["water"]
        self._water = dict(zip(WATER, water.tolist(), strict=True))
        joints = [model.joint("theta"), *(model.joint(f"hinge_{k}") for k in range(1, self.links))]
        self._q = np.array([joint.qposadr[0] for joint in joints])
        self._v = np.array([joint.dofadr[0] for joint in joints])
        self._rows, self._columns = self._places_in_m()
        self._lower = np.tril(np.ones((self.links, self.links)))
        self._base = np.zeros(2)
        self._dashpot = np.zeros(self.links - 1)
        self._bristle = np.zeros(self.links - 1)
        self._last: tuple[float, np.ndarray] | None = None
        self.drag = np.zeros(2)
        self._take_water_out()

    def attach(self) -> None:
        """Register it as MuJoCo's passive callback; it acts on this model only."""
        mujoco.set_mjcb_passive(self)

    def detach(self) -> None:
        """Remove the callback, and reset the material's memory."""
        mujoco.set_mjcb_passive(None)
        self._last = None

    def _take_water_out(self) -> None:
        """Remove MuJoCo's own fluid and the mass that stands for added mass, and put the arm's own numbers in their
        place.
        """
        model = self.model
        model.opt.density, model.opt.viscosity = 0.0, 0.0
        for k in range(self.links):
            body = model.body(f"link_{k}").id
            model.body_mass[body] = self._n["mass"][k]
            model.body_ipos[body] = [0.0, self._n["centre"][k], 0.0]
            across, along = self._n["inertia_across"][k], self._n["inertia_along"][k]
            model.body_inertia[body] = [across, along, across]
            model.body_gravcomp[body] = self._n["gravcomp"][k]
        mujoco.mj_setConst(model, mujoco.MjData(model))

    def _places_in_m(self) -> tuple[np.ndarray, np.ndarray]:
        """Row and column, as places along the arm (-1: not of the arm), of every entry of data.M."""
        model = self.model
        place = np.full(model.nv, -1)
        place[self._v] = np.arange(self.links)
        rows = np.repeat(np.arange(model.nv), model.M_rownnz)
        return place[rows], place[np.asarray(model.M_colind)]

    def __call__(self, model: Any, data: Any) -> None:
        """Add this instant's forces to data.qfrc_passive, and the added mass to data.M."""
        if model.nv != self.model.nv or model.nnumeric != self.model.nnumeric:
            return
        if self._last is None:
            base = model.body("link_0")
            self._base = np.array(base.pos[:2])
        data.qfrc_passive[self._v] += self._water_force(data)
        data.qfrc_passive[self._v[1:]] += self._material(data)
        if np.any(self._carried):
            own = (self._rows >= 0) & (self._columns >= 0)
            data.M[own] += self._carried[self._rows[own], self._columns[own]]
            mujoco.mj_factorM(model, data)

    def _water_force(self, data: Any) -> np.ndarray:
        """Generalised force (n + 1,) of the water; prepares the added mass (n + 1, n + 1)."""
        w, n = self._water, self._n
        motion = self._motion(data)
        start, normal, tangent, rate = motion.start, motion.normal, motion.tangent, motion.rate
        reach = n["node_along"][..., None]
        place = start[:, None] + reach * tangent[:, None]
        relative = motion.slip[:, None] - reach * (rate[:, None] * normal)[:, None]
        u_n = np.sum(relative * normal[:, None], axis=2)
        u_t = np.sum(relative * tangent[:, None], axis=2)
        weight = n["node_weight"]
        f_n, f_t = self._resistance(u_n, u_t, data.time)
        squeezed, wall_n, wall_t = self._wall(place[..., 0], motion, (u_n, u_t))
        force = weight[..., None] * ((f_n + wall_n)[..., None] * normal[:, None])
        force += weight[..., None] * ((f_t + wall_t)[..., None] * tangent[:, None])
        force += (weight * w["density"] * n["node_area"])[..., None] * motion.surge
        total, moment = force.sum(axis=1), _cross(place, force).sum(axis=1)
        self._carried = np.zeros((self.links, self.links))
        tip = start[-1] + n["length"][-1] * tangent[-1]
        shed = self._shed(motion)
        total[-1] += shed
        moment[-1] += _cross(tip, shed)
        self.drag = total.sum(axis=0)
        for reach_beyond, drop, moved in zip(n["body_reach"], n["body_drop"], n["body_moved"], strict=True):
            at = tip + reach_beyond * tangent[-1] + drop * normal[-1]
            total[-1] += moved * motion.surge
            moment[-1] += moved * _cross(at, motion.surge)
        if w["C_a"] > 0.0:
            carried, share = n["carried"], w["tangential"]
            rest = w["convective"] * (1.0 - share) * carried  # whose momentum turns with the link (Kirchhoff)
            self._carry(motion, n["carried_centre"], (carried, share * carried, rest), (total, moment))
            self._carried += self._lower.T @ (n["carried_turning"][:, None] * self._lower)
        if w["wall_B"] > 0.0:
            for g in range(weight.shape[1]):
                mass = weight[:, g] * squeezed[:, g]
                self._carry(motion, n["node_along"][:, g], (mass, np.zeros_like(mass), mass), (total, moment))
        beyond = np.cumsum(total[::-1], axis=0)[::-1]
        return np.cumsum(moment[::-1])[::-1] - _cross(start, beyond)

    def _motion(self, data: Any) -> _Motion:
        phi, rate = np.cumsum(data.qpos[self._q]), np.cumsum(data.qvel[self._v])
        normal = np.stack([np.cos(phi), np.sin(phi)], axis=1)
        tangent = np.stack([-np.sin(phi), np.cos(phi)], axis=1)
        span = self._n["length"][:, None]

        def along(step: np.ndarray) -> np.ndarray:
            """The value at the start of every link, if each link adds `step`."""
            return np.concatenate([np.zeros((1, 2)), np.cumsum(step, axis=0)[:-1]])

        stream, surge = self._stream(data.time)
        start = self._base + along(span * tangent)
        slip = along(-span * rate[:, None] * normal) - stream
        return _Motion(start, slip, along(-span * rate[:, None] ** 2 * tangent) - surge, rate, normal, tangent, surge)

    def _carry(self, motion: _Motion, reach: np.ndarray, masses: Any, sums: tuple[np.ndarray, np.ndarray]) -> None:
        """Added mass at a reach along each link, masses (3, n + 1) [kg]: along n, along t, and the part with convective
        terms. The forces without qacc are added to sums (forces and moments of the links), the rest to M.
        """
        across, round_it, turned = masses
        normal, tangent, rate = motion.normal, motion.tangent, motion.rate
        place = motion.start + reach[:, None] * tangent
        slip = motion.slip - reach[:, None] * rate[:, None] * normal
        bias = motion.bias - reach[:, None] * rate[:, None] ** 2 * tangent
        v_n, v_t = np.sum(slip * normal, axis=1), np.sum(slip * tangent, axis=1)
        a_n, a_t = np.sum(bias * normal, axis=1), np.sum(bias * tangent, axis=1)
        g_n, g_t = -across * a_n - turned * rate * v_t, -turned * rate * v_n - round_it * a_t
        reaction = g_n[:, None] * normal + g_t[:, None] * tangent
        sums[0][:] += reaction
        sums[1][:] += _cross(place, reaction) + turned * v_n * v_t
        for mass, axis in ((across, normal), (round_it, tangent)):
            own = self._swept(motion, place, axis, self._lower)
            self._carried += own.T @ (mass[:, None] * own)

    @staticmethod
    def _swept(motion: _Motion, place: np.ndarray, axis: np.ndarray, below: np.ndarray) -> np.ndarray:
        """How points (P, 2) move along their axes (P, 2) with the joints below them: (P, n + 1)."""
        lever = place[:, None] - motion.start[None, :]
        return (lever[..., 0] * axis[:, 1:] - lever[..., 1] * axis[:, :1]) * below

    def _resistance(self, u_n: np.ndarray, u_t: np.ndarray, t: float) -> tuple[np.ndarray, np.ndarray]:
        """Drag along n and t [N/m] at the nodes: eq. 15 or the cross-flow principle, the growth at small Reynolds
        numbers, the viscous part of an oscillating cylinder, skin friction; and the lift of vortices.
        """
        w, width = self._water, self._n["node_width"]
        speed, half = np.hypot(u_n, u_t), 0.5 * w["density"]
        slow = 10.0 / (speed * width / VISCOSITY + 1e-3) ** (2.0 / 3.0)
        felt = speed * (1.0 + w["reynolds"] * slow) - w["cross_flow"] * (speed - np.abs(u_n))
        depths = np.maximum(width * np.sqrt(np.pi * w["oscillating_f"] / VISCOSITY), 1.0)
        viscous = 2.0 * np.pi * w["density"] * VISCOSITY * (depths + 1.0 - 0.25 / depths)
        f_n = -(half * w["C_perp"] * width * felt + w["c_n"] + w["oscillating"] * viscous) * u_n
        beat = 2.0 * np.pi * 0.2 * w["stream"] / width * t
        f_n += half * width * w["stream"] ** 2 * (w["lift_cos"] * np.cos(beat) + w["lift_sin"] * np.sin(beat))
        return f_n, -(half * w["C_t"] * self._n["node_perimeter"] * speed + 0.5 * w["c_n"]) * u_t

    def _wall(self, x: np.ndarray, motion: _Motion, speed: tuple[np.ndarray, np.ndarray]) -> tuple[np.ndarray, ...]:
        """What a wall at wall_x adds at the nodes: mass along n [kg/m], forces along n and t [N/m]."""
        (u_n, u_t), w, width = speed, self._water, self._n["node_width"]
        squared, away = 0.25 * width**2, w["wall_x"] - x
        gap = (np.sqrt(away**2 + squared) - 0.5 * width) / width
        drag = 0.5 * w["density"] * width * w["C_perp"] * w["wall_B"] / (2.0 + 10.0 * gap) * np.hypot(u_n, u_t) * u_n
        near = away**2 + 0.25 * squared
        mass = w["wall_carried"] * w["wall_B"] * 0.5 * np.pi * w["density"] * squared**2 / near
        growth, cos, sin = 2.0 * away * mass / near, motion.normal[:, :1], motion.normal[:, 1:]
        pull = 0.5 * growth * u_n**2
        return mass, pull * cos - growth * u_n * (u_n * cos - u_t * sin) - drag, -pull * sin

    def _shed(self, motion: _Motion) -> np.ndarray:
        """Force [N] of the water that leaves a tip with an edge (Lighthill 1971)."""
        normal, tangent = motion.normal[-1], motion.tangent[-1]
        slip = motion.slip[-1] - self._n["length"][-1] * motion.rate[-1] * normal
        u_n, leaves = float(slip @ normal), min(float(slip @ tangent), 0.0)  # a tip that leads meets water at rest
        carried = 0.25 * np.pi * self._water["density"] * self._water["shed"] ** 2
        # Implicit in the velocity, because the tip's link is light.
        tip = motion.start[-1:] + self._n["length"][-1] * tangent
        slowed = self._swept(motion, tip, normal[None], self._lower[-1:])
        self._carried -= self.model.opt.timestep * carried * leaves * slowed.T @ slowed
        return carried * u_n * (leaves * normal - 0.5 * u_n * tangent)

    def _stream(self, t: float) -> tuple[np.ndarray, np.ndarray]:
        """Velocity [m/s] and acceleration of the undisturbed water."""
        w = self._water
        omega = 2.0 * np.pi * w["slosh_f"]
        sway = w["U_cos"] * np.cos(omega * t) + w["U_sin"] * np.sin(omega * t)
        surge = omega * (w["U_sin"] * np.cos(omega * t) - w["U_cos"] * np.sin(omega * t))
        faster = SECOND_WAVE * omega
        sway += w["V_cos"] * np.cos(faster * t) + w["V_sin"] * np.sin(faster * t)
        surge += faster * (w["V_sin"] * np.cos(faster * t) - w["V_cos"] * np.sin(faster * t))
        return np.array([w["U_x"] + sway, w["U_y"]]), np.array([surge, 0.0])

    def _material(self, data: Any) -> np.ndarray:
        """Moments (n,) at the hinges beyond those of the springs in MuJoCo: memory, drift, damping that grows with
        bend.
        """
        n = self._n
        angle, rate = data.qpos[self._q[1:]], data.qvel[self._v[1:]]
        self._remember(data.time, angle)
        stiffness, bend = n["hinge_stiffness"], angle - n["hinge_rest"]
        rate_0, settling = n["drift"]
        elapsed = data.time if settling == 0.0 else -np.expm1(-settling * data.time) / settling
        drifted = rate_0 * elapsed  # MuJoCo's own springs and dampers do not drift: that much is added here
        moment = drifted * stiffness * (bend + n["hinge_cubic"] * bend**3)
        remembered = n["hinge_maxwell"] * (angle - self._dashpot)
        remembered += n["hinge_yield_moment"] * self._bristle / np.maximum(n["hinge_yield_angle"], 1e-12)
        moment += (1.0 + drifted) * remembered
        return -moment - self._lossy((1.0 + drifted) * stiffness, bend, rate)

    def _lossy(self, stiffness: np.ndarray, bend: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """The additional moment (n,) of a damping that changes. It goes through dof_damping, which the implicitfast
        integrator treats implicitly. An explicit damping would limit the step at the light links of the tip.
        """
        joints, n = self._v[1:], self._n
        given = self.model.dof_damping[joints].copy()  # MuJoCo has counted it in this step
        wanted = n["hinge_damping"] + stiffness * n["hinge_bent_loss"] * bend**2
        # Sliding friction M tanh(rate / r) as the damping M tanh(rate / r) / rate.
        sliding = np.maximum(np.abs(rate), 1e-9) / np.maximum(n["hinge_sliding_rate"], 1e-12)
        drifted = stiffness / n["hinge_stiffness"]
        wanted += drifted * n["hinge_sliding_moment"] * np.tanh(sliding) / np.maximum(np.abs(rate), 1e-9)
        self.model.dof_damping[joints] = wanted
        return (wanted - given) * rate

    def _remember(self, t: float, angle: np.ndarray) -> None:
        """Advance the dashpots and the bristles of dry friction to time t; they start relaxed."""
        if self._last is None or t < self._last[0]:
            self._dashpot, self._bristle = angle.copy(), np.zeros_like(angle)
        elif t > self._last[0]:
            before, elapsed = self._last[1], t - self._last[0]
            share = -np.expm1(-elapsed / self._n["hinge_relaxation"])
            stretch = (1.0 - share) * (
                before - self._dashpot
            )  # exactly stretch' = rate - stretch / tau, at a steady rate
            stretch += share * self._n["hinge_relaxation"] * (angle - before) / elapsed
            self._dashpot = angle - stretch
            limit = self._n["hinge_yield_angle"]
            self._bristle = np.clip(self._bristle + angle - before, -limit, limit)
        self._last = (t, angle.copy())


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """z component of a x b, over the last axis."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def drive(model: Any, data: Any, base: Any, times: np.ndarray) -> np.ndarray:
    """Move the clamp as base(t) = (theta, rate, acceleration) says, and give qpos (T, nq) at rising times [s].

    The three actuators of arm.xml hold the clamp to it within a microradian.
    """
    kept = np.empty((len(times), model.nq))
    for k, t in enumerate(times):
        while data.time < t - 0.5 * model.opt.timestep:
            # MuJoCo's rates are half a step later than its positions, and implicitfast damps the rate of the next step.
            angle, _, acceleration = base(data.time)
            data.ctrl[:3] = angle, base(data.time + 0.5 * model.opt.timestep)[1], acceleration
            reached = data.time
            mujoco.mj_step(model, data)
            if not data.time > reached:  # MuJoCo begins anew where numbers run away
                raise FloatingPointError(
                    f"the arm ran away at {reached:.3f} s: a shorter timestep than {model.opt.timestep:g} s"
                )
        kept[k] = data.qpos + (t - data.time) * data.qvel
    return kept
