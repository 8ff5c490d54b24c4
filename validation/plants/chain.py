"""A chain of rigid links in MuJoCo, with other links, hinges and steps than the chain that the loop uses.

Hinges stand at the beginnings of equal links, the first at the clamp with half a link's bend. Drawn: 24 to 60
links, steps of .25 to .5 ms. MuJoCo gives M and its bias forces; (M + M_water + h D + h^2 K) a = F at the step's
beginning, v += h a, q += h v: the implicit Euler rule, linear in the step, of first order.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np

from tentacle.compiled import njit
from tentacle.signals import Array
from validation.plants.draw import Trial
from validation.plants.filmed import Mover, Plant
from validation.plants.material import BRANCHES, bending
from validation.plants.tank import on_piece

mujoco: Any = import_module("mujoco")  # its names are made at run time
FEWEST, MOST = 24, 60  # links
STEPS = (5e-4, 1e-3)  # s, at most, of which mover takes halves
SMALLEST = 1e-14  # kg m^2: MuJoCo takes no inertia below 1e-15


def plant(trial: Trial) -> Plant:
    """The trial's chain: the number of links and the step are drawn at random."""
    random = np.random.default_rng([trial.seed, 22])
    links, step = int(random.integers(FEWEST, MOST + 1)), float(random.uniform(*STEPS))
    return Plant(mover(links), step, {"links": links, "step_s": 0.5 * step})


def mover(links: int) -> Mover:
    """The Mover (see filmed) of a chain with that many links; it makes two steps for each requested one."""

    def move(laws: np.ndarray, theta: Array, step: float, every: int) -> tuple[Array, Array]:
        model, mass, centre = _compiled(laws[0], links)
        data = mujoco.MjData(model)
        h, n = 0.5 * step, links
        state = np.zeros((2, n + 1))  # base angle and hinges: positions, rates
        state[0, 0], bent = theta[0], (theta[1] - theta[0]) / h
        state[1, 0] = bent
        memory, bias = np.zeros((n, BRANCHES + 1)), np.zeros(n + 1)
        full, lower = np.zeros((n + 1, n + 1)), np.tril_indices(n + 1)
        places: list[Array] = []
        pulls: list[float] = []
        points, pull = np.zeros((n + 1, 2)), 0.0
        for k in range(theta.size - 1):
            before = theta[max(k - 1, 0)]
            turn = (theta[k + 1] - 2.0 * theta[k] + before) / h**2 if k else 0.0
            state[0, 0] = theta[k]
            state[1, 0] = (theta[k] - before) / h if k else bent - h * turn
            data.qpos[:], data.qvel[:] = state
            data.qacc[:] = 0.0
            data.qacc[0] = turn
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_makeM(model, data)
            mujoco.mj_comVel(model, data)
            mujoco.mj_rne(model, data, 1, bias)
            full[lower] = data.M
            points, pull, hinge = _accelerated(laws[0], state, (turn, bias, full), memory, (mass, centre), (k * h, h))
            if k % (2 * every) == 0:
                places.append(points)
                pulls.append(pull)
            state[1, 1:] += h * hinge
            state[0, 1:] += h * state[1, 1:]
        places.append(points)
        pulls.append(pull)
        found = np.array(places)
        if not np.isfinite(found).all():
            raise FloatingPointError("the chain ran away: take a smaller step")
        return found, np.array(pulls)

    return move


def _compiled(laws: np.void, links: int) -> tuple[Any, Array, Array]:
    """MuJoCo's model, and every link's mass [kg] and its centre from the link's beginning [m]."""
    spec = mujoco.MjSpec()
    down = laws["gravity"]
    spec.option.gravity = [down * np.sin(laws["tilt"]), down * np.cos(laws["tilt"]), 0.0]
    long = float(laws["length"]) / links
    grid, weight = np.polynomial.legendre.leggauss(4)
    body, masses, centres = spec.worldbody, np.zeros(links), np.zeros(links)
    for i in range(links):
        along = 0.5 * long * (grid + 1.0)
        radius = laws["base_radius"] + (laws["tip_radius"] - laws["base_radius"]) * (i + along / long) / links
        line = laws["density"] * (1.0 + laws["heavier"]) * np.pi * radius**2 * 0.5 * long * weight
        masses[i], centres[i] = line.sum(), (line * along).sum() / line.sum()
        across = (line * ((along - centres[i]) ** 2 + 0.25 * radius**2)).sum()
        body = body.add_body(pos=[0.0, long if i else 0.0, 0.0], mass=masses[i], ipos=[0.0, centres[i], 0.0])
        body.inertia, body.explicitinertial = [max(float(across), SMALLEST)] * 3, True
        if i == 0:
            drive = body.add_joint(name="theta", type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
            drive.armature = 1.0  # the base turns as prescribed; two hinges in one place would be singular
        body.add_joint(type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
    if laws["payload"] > 0.0:
        hung = body.add_body(pos=[float(laws["payload_drop"]), long + float(laws["payload_reach"]), 0.0])
        hung.mass, hung.ipos = float(laws["payload"]), [0.0, 0.0, 0.0]
        hung.inertia, hung.explicitinertial = [SMALLEST] * 3, True
    return spec.compile(), masses, centres


@njit(cache=True)
def _accelerated(laws, state: Array, drive, memory: Array, links, times):
    """Nodes (n + 1, 2) [m], the force along y on the mount [N], accelerations of the hinges (n,).

    The memories are advanced. drive: the base's acceleration, MuJoCo's bias forces and mass matrix; links: mass and
    centre (n,); times: t and half the step [s].
    """
    turn, bias, full = drive
    mass, centre = links
    t, h = times
    n = mass.size
    long = laws.length / n
    matrix, force = np.zeros((n, n)), np.zeros(n)
    for i in range(n):
        for j in range(i + 1):
            matrix[i, j] = full[i + 1, j + 1]
            matrix[j, i] = full[i + 1, j + 1]
        force[i] = -bias[i + 1]
    points, speed, swing = np.zeros((n + 1, 2)), np.zeros((n + 1, 2)), np.zeros((n + 1, 2))
    columns, along = np.zeros(n), np.zeros(n)
    down_x, down_y = laws.gravity * np.sin(laws.tilt), laws.gravity * np.cos(laws.tilt)
    kept = np.zeros(BRANCHES + 1)
    phi, rate = state[0, 0], state[1, 0]
    outside = 0.0  # along y: what pulls the arm
    arms = np.zeros((n + 1, n))  # d y of mass centres / d hinge
    masses = np.zeros(n + 1)
    fixed = np.zeros(n + 1)
    reaction = np.zeros(n)  # of the water that is carried, along y, to the hinges' accelerations
    for i in range(n):
        phi, rate = phi + state[0, i + 1], rate + state[1, i + 1]
        nx, ny = np.cos(phi), np.sin(phi)
        tx, ty = -ny, nx
        # Along the link p = start + a t: velocity -a rate n, acceleration -a (turn n + rate^2 t), hinges unaccelerated.
        for axis in range(2):
            n_a, t_a = (nx, ny)[axis], (tx, ty)[axis]
            points[i + 1, axis] = points[i, axis] + long * t_a
            speed[i + 1, axis] = speed[i, axis] - long * rate * n_a
            swing[i + 1, axis] = swing[i, axis] - long * (turn * n_a + rate * rate * t_a)
        radius = laws.base_radius + (laws.tip_radius - laws.base_radius) * (i + 0.5) / n
        px, py = 0.5 * (points[i, 0] + points[i + 1, 0]), 0.5 * (points[i, 1] + points[i + 1, 1])
        vx, vy = 0.5 * (speed[i, 0] + speed[i + 1, 0]), 0.5 * (speed[i, 1] + speed[i + 1, 1])
        ax, ay = 0.5 * (swing[i, 0] + swing[i + 1, 0]), 0.5 * (swing[i, 1] + swing[i + 1, 1])
        push_n, push_t, couple, inertia, slope = on_piece(
            laws, ((i + 0.5) / n, radius), (px, py, nx, ny), (vx, vy, ax, ay), rate, t
        )
        sunk = -laws.water * (1.0 + laws.saltier) * np.pi * radius * radius
        fx = long * (push_n * nx + push_t * tx + sunk * down_x)
        fy = long * (push_n * ny + push_t * ty + sunk * down_y)
        outside += fy + mass[i] * down_y
        masses[i], fixed[i] = mass[i], swing[i, 1] - centre[i] * (turn * ny + rate * rate * ty)
        for j in range(i + 1):
            rx, ry = px - points[j, 0], py - points[j, 1]  # a turn of hinge j moves the middle by (-ry, rx)
            columns[j], along[j] = -ry * nx + rx * ny, -ry * tx + rx * ty
            force[j] += -ry * fx + rx * fy + long * couple
            arms[i, j] = points[i, 0] + centre[i] * tx - points[j, 0]
        carried = long * (inertia + h * slope)
        for j in range(i + 1):
            reaction[j] += long * inertia * columns[j] * ny
            for k in range(i + 1):
                matrix[j, k] += carried * columns[j] * columns[k]
        # The hinge at the link's beginning; the clamp bends over half a link.
        s = i / n if i else 0.25 / n
        unit = n if i else 2.0 * n
        second = 0.25 * np.pi * (laws.base_radius + (laws.tip_radius - laws.base_radius) * s) ** 4
        ahead = unit * (state[0, i + 1] + h * state[1, i + 1])
        moment, stiff = bending(laws, (s, second), (ahead, unit * state[1, i + 1]), (memory[i], kept), t + h, 2.0 * h)
        memory[i] = kept
        force[i] -= moment
        matrix[i, i] += h * stiff * unit
    if laws.payload > 0.0 or laws.magnet != 0.0 or laws.thread != 0.0:
        nx, ny = np.cos(phi), np.sin(phi)
        ox, oy = laws.payload_drop * nx - laws.payload_reach * ny, laws.payload_drop * ny + laws.payload_reach * nx
        px, py = points[n, 0] + ox, points[n, 1] + oy
        ax, ay = swing[n, 0] - turn * oy - rate * rate * ox, swing[n, 1] + turn * ox - rate * rate * oy
        displaced = laws.payload * laws.water / laws.payload_density
        carries = 0.5 * displaced
        fx, fy = -displaced * down_x - carries * ax, -displaced * down_y - carries * ay
        mx, my = laws.magnet_x - points[n, 0], laws.magnet_y - points[n, 1]
        draw = laws.magnet / (mx * mx + my * my + 2.5e-5) ** 1.5
        wx, wy = laws.anchor_x - points[n, 0], laws.anchor_y - points[n, 1]
        far = np.sqrt(wx * wx + wy * wy)
        taut = laws.thread * max(0.0, far - laws.slack) / max(far, 1e-9)
        tip_x, tip_y = draw * mx + taut * wx, draw * my + taut * wy
        outside += fy + tip_y + laws.payload * down_y
        masses[n], fixed[n] = laws.payload, ay
        for j in range(n):
            rx, ry = px - points[j, 0], py - points[j, 1]
            force[j] += -ry * fx + rx * fy
            force[j] += -(points[n, 1] - points[j, 1]) * tip_x + (points[n, 0] - points[j, 0]) * tip_y
            arms[n, j] = rx
            reaction[j] += carries * rx
            for k in range(n):
                sx, sy = px - points[k, 0], py - points[k, 1]
                matrix[j, k] += carries * (rx * sx + ry * sy)
    hinge = np.linalg.solve(matrix, force)
    inertial = np.dot(reaction, hinge)
    for i in range(n + 1):
        inertial += masses[i] * (fixed[i] + np.dot(arms[i], hinge))
    return points, outside - inertial, hinge
