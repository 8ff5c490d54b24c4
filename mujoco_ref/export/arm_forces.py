"""The water's forces on an exported arm, and its material's memory, as one passive callback of MuJoCo.

    model = mujoco.MjModel.from_xml_path("arm.xml")
    forces = Forces(model)              # first: it takes MuJoCo's own water out of the model
    data = mujoco.MjData(model)
    forces.attach()                     # mujoco.set_mjcb_passive; forces.detach() ends it

The numbers stand in arm.xml (<custom>), so this file is the same for every arm; it needs numpy and mujoco alone. Per
length, with u the velocity relative to the water, n the normal and t the tangent of a link:

    drag        f_n = -(1/2 rho C_perp w |u| + c_n) u_n,   f_t = -(1/2 rho C_t P |u| + c_n/2) u_t
    added mass  m_a = C_a rho pi w^2/4 along n (a share of it along t), added to data.M before MuJoCo solves with it

Limits: the arm's clamp turns about z and does not travel; links move in the plane; C callbacks do not exist in MJX.
"""

from __future__ import annotations

from typing import Any

import mujoco as _mujoco
import numpy as np

mujoco: Any = _mujoco
SECOND_WAVE = 1.7320508075688772  # of a deep tank: frequency of its second odd standing wave over the first, sqrt(3)
NAME_PREFIX = "tentacle_"


class Forces:
    """Forces of one exported arm. drag (2,): the water's force on it [N] in the base frame, without added mass."""

    def __init__(self, model: Any) -> None:
        """Read the numbers and put the arm's own mass, inertia and buoyancy in the place of those that stood in."""
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
        fields = ("density", "C_perp", "C_t", "C_a", "tangential", "c_n", "U_x", "U_y", "U_cos", "U_sin", "slosh_f")
        fields = (*fields, "second_cos", "second_sin")
        self._water = dict(zip(fields, water.tolist(), strict=True))
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
        """Let MuJoCo call it in every step, for this model alone."""
        mujoco.set_mjcb_passive(self)

    def detach(self) -> None:
        """Take it out of MuJoCo again, and forget what the material remembers."""
        mujoco.set_mjcb_passive(None)
        self._last = None

    def _take_water_out(self) -> None:
        """MuJoCo's own fluid and the mass that stood for added mass leave; the arm's own numbers take their place."""
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
        if self._water["C_a"] > 0.0:
            own = (self._rows >= 0) & (self._columns >= 0)
            data.M[own] += self._carried[self._rows[own], self._columns[own]]
            mujoco.mj_factorM(model, data)

    def _water_force(self, data: Any) -> np.ndarray:
        """Generalised force (n + 1,) of the water; prepares the added mass (n + 1, n + 1)."""
        w, n = self._water, self._n
        phi, rate = np.cumsum(data.qpos[self._q]), np.cumsum(data.qvel[self._v])
        normal = np.stack([np.cos(phi), np.sin(phi)], axis=1)
        tangent = np.stack([-np.sin(phi), np.cos(phi)], axis=1)
        span = n["length"][:, None]

        def along(step: np.ndarray) -> np.ndarray:
            """What every link starts from, where each adds `step`."""
            return np.concatenate([np.zeros((1, 2)), np.cumsum(step, axis=0)[:-1]])

        start = self._base + along(span * tangent)
        velocity = along(-span * rate[:, None] * normal)
        centripetal = along(-span * rate[:, None] ** 2 * tangent)
        stream, surge = self._stream(data.time)
        reach = n["node_along"][..., None]
        place = start[:, None] + reach * tangent[:, None]
        relative = velocity[:, None] - reach * (rate[:, None] * normal)[:, None] - stream
        u_n = np.sum(relative * normal[:, None], axis=2)
        u_t = np.sum(relative * tangent[:, None], axis=2)
        speed = np.hypot(u_n, u_t)
        width, perimeter, weight = n["node_width"], n["node_perimeter"], n["node_weight"]
        f_n = -(0.5 * w["density"] * w["C_perp"] * width * speed + w["c_n"]) * u_n
        f_t = -(0.5 * w["density"] * w["C_t"] * perimeter * speed + 0.5 * w["c_n"]) * u_t
        force = weight[..., None] * (f_n[..., None] * normal[:, None] + f_t[..., None] * tangent[:, None])
        force += (weight * w["density"] * n["node_area"])[..., None] * surge
        force += (weight * self._unnamed(place[..., 0], u_n))[..., None] * normal[:, None]
        total, moment = force.sum(axis=1), _cross(place, force).sum(axis=1)
        self.drag = total.sum(axis=0)
        tip = start[-1] + n["length"][-1] * tangent[-1]
        for reach_beyond, drop, moved in zip(n["body_reach"], n["body_drop"], n["body_moved"], strict=True):
            at = tip + reach_beyond * tangent[-1] + drop * normal[-1]
            total[-1] += moved * surge
            moment[-1] += moved * _cross(at, surge)
        if w["C_a"] > 0.0:
            carried, share = n["carried"], w["tangential"]
            centre = n["carried_centre"][:, None]
            middle = start + centre * tangent
            moving = velocity - centre * rate[:, None] * normal - stream
            bias = centripetal - centre * rate[:, None] ** 2 * tangent - surge
            v_n, v_t = np.sum(moving * normal, axis=1), np.sum(moving * tangent, axis=1)
            a_n, a_t = np.sum(bias * normal, axis=1), np.sum(bias * tangent, axis=1)
            rest = (1.0 - share) * carried
            g_n = -carried * a_n - rest * rate * v_t
            g_t = -rest * rate * v_n - share * carried * a_t
            reaction = g_n[:, None] * normal + g_t[:, None] * tangent
            total = total + reaction
            moment = moment + _cross(middle, reaction) + rest * v_n * v_t
            self._carried = self._added_mass(start, middle, normal, tangent)
        beyond = np.cumsum(total[::-1], axis=0)[::-1]
        return np.cumsum(moment[::-1])[::-1] - _cross(start, beyond)

    def _added_mass(self, start: np.ndarray, middle: np.ndarray, normal: np.ndarray, tangent: np.ndarray) -> np.ndarray:
        """Added mass on the joints (n + 1, n + 1): J_n' m J_n + share J_t' m J_t + J_phi' i J_phi."""
        lever = middle[:, None] - start[None, :]  # (link, joint)
        turned = np.stack([-lever[..., 1], lever[..., 0]], axis=2) * self._lower[..., None]
        j_n = np.einsum("kjx,kx->kj", turned, normal)
        j_t = np.einsum("kjx,kx->kj", turned, tangent)
        carried, turning = self._n["carried"][:, None], self._n["carried_turning"][:, None]
        share = self._water["tangential"]
        return j_n.T @ (carried * j_n) + share * j_t.T @ (carried * j_t) + self._lower.T @ (turning * self._lower)

    def _unnamed(self, x: np.ndarray, u_n: np.ndarray) -> np.ndarray:
        """Forces along the normal [N/m] that the model has no name for; u_n relative to the water."""
        push, tether, tip_tether, bowed_tether, tip_brake, density = self._n["rest"]
        towards = ((self._n["from_base"][:, None] + self._n["node_along"]) / self._n["length"].sum()) ** 3
        per_mass = (
            push * towards + x * (tether + tip_tether * towards) + bowed_tether * x**2 + tip_brake * u_n * towards
        )
        return -density * self._n["node_area"] * per_mass

    def _stream(self, t: float) -> tuple[np.ndarray, np.ndarray]:
        """Velocity [m/s] and acceleration of the undisturbed water."""
        w = self._water
        omega = 2.0 * np.pi * w["slosh_f"]
        sway = w["U_cos"] * np.cos(omega * t) + w["U_sin"] * np.sin(omega * t)
        surge = omega * (w["U_sin"] * np.cos(omega * t) - w["U_cos"] * np.sin(omega * t))
        faster = SECOND_WAVE * omega
        along = w["U_cos"] * w["second_cos"] - w["U_sin"] * w["second_sin"]
        across = w["U_cos"] * w["second_sin"] + w["U_sin"] * w["second_cos"]
        sway += along * np.cos(faster * t) + across * np.sin(faster * t)
        surge += faster * (across * np.cos(faster * t) - along * np.sin(faster * t))
        return np.array([w["U_x"] + sway, w["U_y"]]), np.array([surge, 0.0])

    def _material(self, data: Any) -> np.ndarray:
        """Moments (n,) at the hinges that MuJoCo's springs do not know: memory, drift, damping that grows with bend."""
        n = self._n
        angle, rate = data.qpos[self._q[1:]], data.qvel[self._v[1:]]
        self._remember(data.time, angle)
        stiffness, bend = n["hinge_stiffness"], angle - n["hinge_rest"]
        rate_0, settling = n["drift"]
        elapsed = data.time if settling == 0.0 else -np.expm1(-settling * data.time) / settling
        drifted = rate_0 * elapsed  # MuJoCo's own springs and dampers do not drift: that much is added here
        elastic = (1.0 + n["hinge_stiff_tip"]) * bend + n["hinge_one_sided"] * bend**2 + n["hinge_cubic"] * bend**3
        moment = drifted * stiffness * elastic
        remembered = n["hinge_maxwell"] * (angle - self._dashpot)
        remembered += n["hinge_yield_moment"] * self._bristle / np.maximum(n["hinge_yield_angle"], 1e-12)
        moment += (1.0 + drifted) * (remembered + stiffness * n["hinge_set_tip"])
        return -moment - self._lossy((1.0 + drifted) * stiffness, bend, rate)

    def _lossy(self, stiffness: np.ndarray, bend: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """What damping that changes adds (n,). It is put into dof_damping, in which implicitfast is implicit: at the
        tip's light links an explicit one would limit the step."""
        joints, n = self._v[1:], self._n
        given = self.model.dof_damping[joints].copy()  # MuJoCo has counted it in this step
        wanted = n["hinge_damping"] + stiffness * (n["hinge_loss"] + n["hinge_bent_loss"] * bend**2)
        # Sliding friction M tanh(rate / r) as the damping M tanh(rate / r) / rate.
        sliding = np.maximum(np.abs(rate), 1e-9) / np.maximum(n["hinge_sliding_rate"], 1e-12)
        drifted = stiffness / n["hinge_stiffness"]
        wanted += drifted * n["hinge_sliding_moment"] * np.tanh(sliding) / np.maximum(np.abs(rate), 1e-9)
        self.model.dof_damping[joints] = wanted
        return (wanted - given) * rate

    def _remember(self, t: float, angle: np.ndarray) -> None:
        """Carry the dashpots and the bristles of dry friction on to time t; they start relaxed."""
        if self._last is None or t < self._last[0]:
            self._dashpot, self._bristle = angle.copy(), np.zeros_like(angle)
        elif t > self._last[0]:
            before, elapsed = self._last[1], t - self._last[0]
            share = -np.expm1(-elapsed / self._n["hinge_relaxation"])
            self._dashpot = self._dashpot + share * (0.5 * (before + angle) - self._dashpot)
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
            # MuJoCo's rates stand half a step beside its positions, and implicitfast damps the rate that comes.
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
