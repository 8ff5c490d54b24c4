"""One step of time: the implicit midpoint rule on MuJoCo's mass matrix and bias forces.

MuJoCo's own integrators are of first order here (`discrete`: 2.3 % of tip amplitude at 10 ms) and cannot
carry the anisotropic added mass. So MuJoCo gives kinematics, M(q) and M a + C v + g at the middle of the step. One
Newton correction, from the previous step's acceleration, gives the new acceleration. Elasticity, damping and drag are
in its matrix, so accuracy and not stability limits the step: second order, stable at 10 ms.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mujoco_ref.chain import Chain
from mujoco_ref.chain_state import ChainState
from mujoco_ref.engine import mujoco
from mujoco_ref.hinges import Drift, hinge_moments, remember
from mujoco_ref.influence import Fields, Record
from mujoco_ref.mount import base_forces, base_remember, hull_forces
from mujoco_ref.step_arguments import ChainConstants, Equation, Laws, Midpoint, Moving, Now, Workspace
from mujoco_ref.water import MASS, VOLUME, VOLUME_CENTRE, link_motion, link_table, node_table, water_forces
from mujoco_ref.written_laws import Bending, WrittenLaws
from tentacle.compiled import njit
from tentacle.signals import Array

STEEP = ("yield_moment", "sliding_moment", "cubic", "bent_loss")  # hinge laws with a corner or a steep curve
Plain = tuple[Any, ...]  # the fields of a NamedTuple of step_arguments


@njit(cache=True)
def _predict(state: Plain, held: Array, motor: Array, step: float, middle: Array, rate: Array) -> None:
    """Positions and rates at the middle of a step, from the acceleration a; held coordinates are where they are put."""
    q, v, a = state[:3]
    half = 0.5 * step
    for i in range(q.shape[0]):
        middle[i] = q[i] + half * v[i] + half * half * a[i]
        rate[i] = v[i] + half * a[i]
    for i in range(2):
        if held[i] and motor.shape[1] > 3:
            middle[i], rate[i], a[i] = motor[1, 3 + i], motor[1, 5 + i], motor[1, 7 + i]
        elif held[i]:
            middle[i], rate[i], a[i] = q[i], 0.0, 0.0
    if held[2]:
        middle[2], rate[2], a[2] = motor[1, 0], motor[1, 1], motor[1, 2]


@njit(cache=True)
def _add_tension(motion: Array, body: ChainConstants, water: Fields, scale: float, matrix: Array) -> None:
    """Add scale times the stiffness that weight and inertial forces give the joints: a heavy tip tightens the chain.

    A change of joint j turns all links beyond it, and with them the levers of their forces about the joints from the
    base to j. An explicit term would limit the step: with a payload of a tenth of the arm's mass, 40 links and 4 ms
    must be stable.
    """
    links, bodies, gravity = body.links, body.bodies, body.gravity
    count = links.shape[0]
    end = motion[count]
    fx, fy, work = 0.0, 0.0, 0.0
    c, s = np.cos(end[6]), np.sin(end[6])
    for k in range(bodies.shape[0]):
        mass, reach, drop, volume = bodies[k]
        net = mass - water.density * volume
        gx, gy = net * gravity[0] - mass * end[4], net * gravity[1] - mass * end[5]
        fx, fy = fx + gx, fy + gy
        work += gx * (end[0] - reach * s + drop * c) + gy * (end[1] + reach * c + drop * s)
    for k in range(count - 1, -1, -1):
        x0, y0, _, _, ax0, ay0, phi, rate, acceleration = motion[k]
        c, s, reach = np.cos(phi), np.sin(phi), links[k, VOLUME_CENTRE]
        ax = ax0 + reach * (rate**2 * s - acceleration * c)
        ay = ay0 - reach * (rate**2 * c + acceleration * s)
        net = links[k, MASS] - water.density * links[k, VOLUME]
        gx, gy = net * gravity[0] - links[k, MASS] * ax, net * gravity[1] - links[k, MASS] * ay
        fx, fy, work = fx + gx, fy + gy, work + gx * (x0 - reach * s) + gy * (y0 + reach * c)
        stiffness = scale * (work - fx * x0 - fy * y0)
        for j in range(k + 1):
            matrix[2 + k, 2 + j] += stiffness
            if j != k:
                matrix[2 + j, 2 + k] += stiffness


@njit(cache=True)
def _solve(matrix: Array, residual: Array, held: Array, change: Array) -> None:
    """matrix change = residual on the coordinates that are free; by Cholesky from the tip's row down, in place."""
    size = residual.shape[0]
    index = np.empty(size, np.int64)
    count = 0
    for i in range(size):
        change[i] = 0.0
        if i > 2 or not held[i]:
            index[count] = i
            count += 1
    lower = np.empty((count, count))
    x = np.empty(count)
    for i in range(count):
        for j in range(i + 1):
            total = matrix[index[i], index[j]]
            for k in range(j):
                total -= lower[i, k] * lower[j, k]
            lower[i, j] = np.sqrt(total) if i == j else total / lower[j, j]
        total = residual[index[i]]
        for k in range(i):
            total -= lower[i, k] * x[k]
        x[i] = total / lower[i, i]
    for i in range(count - 1, -1, -1):
        total = x[i]
        for k in range(i + 1, count):
            total -= lower[k, i] * x[k]
        x[i] = total / lower[i, i]
        change[index[i]] = x[i]


@njit(cache=True)
def _correct(moving: Plain, workspace: Plain, chain: tuple[Plain, Plain], held: Array, motor: Array, at: Plain) -> None:
    """Correct the accelerations a (n + 3,) by one Newton iteration; writes the workspace's reading."""
    state, work, now = Moving(*moving), Workspace(*workspace), Now(*at)
    body, laws = ChainConstants(*chain[0]), Laws(*chain[1])
    middle, rate, out = work.middle, work.rate, work.reading
    base = laws.base[0]
    size = state.q.shape[0]
    force = np.empty(size)
    matrix = np.empty((size, size))
    entry = 0
    for i in range(size):
        force[i] = -work.inverse[i]
        for j in range(i + 1):
            matrix[i, j] = work.mass[entry]
            matrix[j, i] = work.mass[entry]
            entry += 1
    for i in range(2):
        force[i] -= body.mount_mass * body.gravity[i]
    link_motion(middle, rate, state.a, body.links, work.motion)
    equation = Equation(force, matrix, np.empty(4))
    course = Midpoint(state.q, middle, rate)
    water_forces(work.motion, body, laws, now.t, 0.5 * now.step, equation)
    _add_tension(work.motion, body, laws.water[0], 0.25 * now.step * now.step, matrix)
    hinge_moments(course, laws.hinges, state.hinge_memory, now, equation)
    torque = base_forces(course, motor, base, state.base_memory, now.step, equation)
    if base.hull != 0.0:
        torque = hull_forces(course, motor, laws, now, state.a[2], equation)
    change = np.empty(size)
    _solve(matrix, force, held, change)
    # The force that holds the mount: the residual of the rows of the held coordinates.
    for i in range(3):
        reaction = -force[i]
        for j in range(size):
            reaction += matrix[i, j] * change[j]
        out[2 + i] = reaction if held[i] else 0.0
    if not held[2]:
        out[4] = torque - base.hull_inertia * change[2]
    if not held[0]:
        out[2] = -(base.spring_x * middle[0] + base.damper_x * rate[0])
    out[0], out[1] = equation.sums[0], equation.sums[1]
    for i in range(size):
        state.a[i] += change[i]


@njit(cache=True)
def _finish(moving: Plain, held: Array, motor: Array, laws: tuple[Record, Record], torque: float, step: float) -> None:
    """Move q and v over the step with the mean acceleration a, and carry the memories of hinges and base."""
    q, v, a, hinge_memory, base_memory = moving
    hinges, base = laws
    start = q.copy()
    for i in range(q.shape[0]):
        q[i] += step * v[i] + 0.5 * step * step * a[i]
        v[i] += step * a[i]
    for i in range(2):
        if held[i] and motor.shape[1] > 3:
            q[i], v[i] = motor[2, 3 + i], motor[2, 5 + i]
        elif held[i]:
            q[i], v[i] = start[i], 0.0
    if held[2]:
        q[2], v[2] = motor[2, 0], motor[2, 1]
    remember(start, q, hinges, hinge_memory, step)
    base_remember((start, q), motor, torque, base[0], base_memory, step)


class Stepper:
    """Steps one chain in time. It owns all its arrays: use one Stepper per thread.

    A step's reading, in `reading` (5,): fluid force x, y [N] (eq. 17); the force x, y [N] and the torque about z [N m]
    that hold the mount, all at the middle of the step.
    """

    def __init__(self, chain: Chain, laws: Laws, drift: Drift, written: WrittenLaws | None = None) -> None:
        """drift: of all elastic stiffnesses; written: laws of effect files."""
        self.chain, self.laws, self.drift, self.written = chain, laws, drift, written
        self.data = mujoco.MjData(chain.model)
        base = laws.base[0]
        self.held = np.array([not base[name] for name in ("free_x", "free_y", "free_theta")])
        self.reading = np.zeros(5)
        # Steep laws need Newton's method to converge; the smooth ones are right after one step.
        steep = any(np.any(laws.hinges[name] != 0.0) for name in STEEP)
        loose = any(base[name] > 0.0 for name in ("play", "slip_moment", "hub_friction", "rail_friction"))
        self.corrections = 4 if steep or loose else 1
        # The rail or stand carries the mount's own weight.
        gravity = np.array(chain.model.opt.gravity[:2])
        mount_mass = float(chain.model.body_mass[1])
        self.body = ChainConstants(link_table(chain), node_table(chain), chain.bodies, mount_mass, gravity)
        # Views into MuJoCo's own memory: writing middle and rate is what sets its state.
        data, size = self.data, chain.links + 3
        motion = np.zeros((chain.links + 2, 9))
        self._work = Workspace(data.qpos, data.qvel, data.M, np.zeros(size), motion, self.reading)
        # Plain tuples reach compiled code three times as fast as named ones.
        self._chain = tuple(self.body), tuple(self.laws)
        self._remember = laws.hinges, laws.base

    def step(self, state: ChainState, motor: Array, step: float, corrections: int = 1) -> None:
        """Move state on by `step` [s]. motor (3, 3): angle, rate, acceleration at the start, middle and end of it;
        (3, 9) of a base that travels: then its x, y [m], their rates and accelerations."""
        model, data, work = self.chain.model, self.data, self._work
        moving, workspace = tuple(state.moving), tuple(work)
        t = state.t + 0.5 * step
        now = (t, step, self.drift.factor(t))
        pull = np.zeros(2)
        for _ in range(corrections):
            _predict(moving, self.held, motor, step, work.middle, work.rate)
            data.qacc[:] = state.a
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_makeM(model, data)
            mujoco.mj_comVel(model, data)
            mujoco.mj_rne(model, data, 1, work.inverse)
            pull = self._written(state, t, step)
            _correct(moving, workspace, self._chain, self.held, motor, now)
        self.reading[:2] += pull
        if self.written is not None:
            state.law_memory = self.written.remembered(state.law_memory, state.v[3:] + 0.5 * step * state.a[3:], step)
        _finish(moving, self.held, motor, self._remember, self.reading[4], step)
        state.t += step

    def _written(self, state: ChainState, t: float, step: float) -> Array:
        """Add the written laws' forces at MuJoCo's present state to its bias force, and the slopes of their moments
        over a step to its mass matrix, which is then Newton's matrix. Returns the forces' sum (2,) [N].
        """
        if self.written is None:
            return np.zeros(2)
        laws, work, diagonal = self.written, self._work, np.cumsum(np.arange(1, self.chain.links + 4)) - 1
        if not state.law_memory.size:
            state.law_memory = np.zeros((len(laws.acting), self.chain.links))
        link_motion(work.middle, work.rate, self.data.qacc, self.body.links, work.motion)
        force, pull = laws.forces(work.motion, t)
        rest = self.laws.hinges["rest"]
        at = Bending(work.middle[3:], work.rate[3:], rest, state.law_memory, t, self.drift.factor(t))
        moment, slope = laws.moments(at, step)
        work.inverse[:] -= force
        work.inverse[3:] += moment
        work.mass[diagonal[3:]] += slope
        return pull

    def residual(self, state: ChainState) -> Array:
        """Generalised force (n + 3,) that is not balanced where the chain stands still in this state, at its time.

        At rest bristles and dashpots carry no force: friction is zero and Maxwell branches have relaxed.
        """
        memory = np.stack([np.zeros(self.chain.links), state.q[3:]], axis=1)
        zeros = np.zeros(self.chain.links + 3)
        return self.balance(ChainState(state.q, zeros, zeros, memory, state.base_memory, state.t))[1]

    def balance(self, state: ChainState) -> tuple[Array, Array]:
        """(M, F): mass matrix (n + 3, n + 3), with the water that is carried, and force (n + 3,) of M a = F in this
        state; without what acts at the base."""
        size, model, data, work = self.chain.links + 3, self.chain.model, self.data, self._work
        work.middle[:], work.rate[:], data.qacc[:] = state.q, state.v, 0.0
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_makeM(model, data)
        mujoco.mj_comVel(model, data)
        mujoco.mj_rne(model, data, 0, work.inverse)
        self._written(state, state.t, 0.0)
        matrix = np.zeros((size, size))
        matrix[np.tril_indices(size)] = work.mass
        matrix += np.tril(matrix, -1).T
        force = -work.inverse
        force[:2] -= self.body.mount_mass * self.body.gravity
        link_motion(state.q, state.v, np.zeros(size), self.body.links, work.motion)
        equation = Equation(force, matrix, np.zeros(4))
        water_forces(work.motion, self.body, self.laws, state.t, 0.0, equation)
        now = Now(state.t, 1e-9, self.drift.factor(state.t))
        implicit = Equation(force, np.zeros((size, size)), equation.sums)  # of a step that takes no time
        hinge_moments(Midpoint(state.q, state.q, state.v), self.laws.hinges, state.hinge_memory, now, implicit)
        return matrix, force
