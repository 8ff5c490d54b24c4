"""A chain of rigid links in MuJoCo, with other links, hinges and steps than the chain that the loop uses.

Hinges stand at the beginnings of equal links, the first at the clamp with half a link's bend. Drawn: 24 to 60
links, steps of .5 to 1 ms. MuJoCo gives M and its bias forces. Implicit midpoint steps, of second order: M a = F
at mid-step, q + h/2 v + h^2/4 a and v + h/2 a, found by a few quasi-Newton iterations with M + h/2 D + h^2/4 K.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np

from tentacle.compiled import njit
from tentacle.signals import Array
from validation.plants.draw import Trial
from validation.plants.filmed import Mover, Plant
from validation.plants.material import BRANCHES, bending, slides
from validation.plants.tank import on_piece

mujoco: Any = import_module("mujoco")  # its names are made at run time
FEWEST, MOST = 24, 60  # links
STEPS = (5e-4, 1e-3)  # s, at most
ROUNDS, ROUNDS_SLIDING = 2, 6  # more if friction is steep (material.slides): 6 and 20 differ by .004 micrometres
SMALLEST = 1e-14  # kg m^2: MuJoCo takes no inertia below 1e-15


def plant(trial: Trial) -> Plant:
    """The trial's chain: the number of links and the step are drawn at random."""
    random = np.random.default_rng([trial.seed, 22])
    links, step = int(random.integers(FEWEST, MOST + 1)), float(random.uniform(*STEPS))
    return Plant(mover(links), step, {"links": links, "step_s": step})


def mover(links: int) -> Mover:
    """The Mover (see filmed) of a chain with that many links."""

    def move(laws: np.ndarray, theta: Array, step: float, every: int) -> tuple[Array, Array]:
        model, mass, centre = _compiled(laws[0], links)
        data = mujoco.MjData(model)
        half, n = 0.5 * step, links
        rounds = ROUNDS_SLIDING if slides(laws[0]) else ROUNDS
        bend, rate, hinge = np.zeros(n), np.zeros(n), np.zeros(n)
        memory = np.zeros((n, BRANCHES + 1))
        state, kept, bias = np.zeros((2, n + 1)), np.zeros_like(memory), np.zeros(n + 1)
        full, lower = np.zeros((n + 1, n + 1)), np.tril_indices(n + 1)
        places: list[Array] = []
        pulls: list[float] = []
        pull = 0.0
        turns = _accelerations(theta, step)
        for k in range((theta.size - 1) // 2):
            before, middle, after = theta[2 * k : 2 * k + 3]
            turn = turns[k]
            if k % every == 0:
                places.append(_nodes(before, bend, float(laws["length"][0])))
            for _ in range(rounds):
                speed = rate + half * hinge
                state[0, 0], state[0, 1:] = middle, bend + half * speed
                state[1, 0], state[1, 1:] = (after - before) / step, speed
                data.qpos[:], data.qvel[:] = state
                data.qacc[:] = 0.0
                data.qacc[0] = turn
                mujoco.mj_kinematics(model, data)
                mujoco.mj_comPos(model, data)
                mujoco.mj_makeM(model, data)
                mujoco.mj_comVel(model, data)
                mujoco.mj_rne(model, data, 1, bias)
                full[lower] = data.M
                drive, times = (turn, bias, full, hinge), ((k + 0.5) * step, half)
                pull, hinge = _accelerated(laws[0], state, drive, (memory, kept), (mass, centre), times)
            if k % every == 0:
                pulls.append(pull)
            bend += step * (rate + half * hinge)
            rate += step * hinge
            memory = 2.0 * kept - memory
        places.append(_nodes(theta[-1], bend, float(laws["length"][0])))
        pulls.append(pull)
        found = np.array(places)
        if not np.isfinite(found).all():
            raise FloatingPointError("the chain ran away: take a smaller step")
        return found, np.array(pulls)

    return move


def _accelerations(theta: Array, step: float) -> Array:
    """Accelerations (K,) of an angle sampled at half steps (2 K + 1,), in the middles of the steps.

    Each is the change between the rates half a step before and after it. So a rate that jumps, as behind a gear with
    play, strikes by just its jump, wherever in a step it does. Before and after its samples the angle goes on smoothly.
    """
    before, after = (3.0 * ends[0] - 3.0 * ends[1] + ends[2] for ends in (theta[:3], theta[:-4:-1]))
    middles = np.concatenate([[before], theta[1::2], [after]])
    return (middles[2:] - 2.0 * middles[1:-1] + middles[:-2]) / step**2


def _nodes(angle: float, bend: Array, length: float) -> Array:
    """Nodes (n + 1, 2) [m] of n links with these hinge angles (n,) below a base at this angle [rad]."""
    phi = angle + np.cumsum(bend)
    steps = length / bend.size * np.stack([-np.sin(phi), np.cos(phi)], axis=1)
    return np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])


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
def _accelerated(laws, state: Array, drive, memories: tuple[Array, Array], links, times):
    """The force along y on the mount [N], and the next iterate of the hinges' accelerations (n,), at mid-step.

    drive: the base's acceleration, MuJoCo's bias forces and mass matrix, and the accelerations with which the state at
    mid-step was found; memories: at the step's start, and written, at mid-step; links: mass and centre (n,); times: t
    of mid-step and half the step [s].
    """
    turn, bias, full, supposed = drive
    memory, kept = memories
    mass, centre = links
    t, h = times
    n = mass.size
    long = laws.length / n
    matrix, force = np.zeros((n, n)), np.zeros(n)
    yields = np.zeros(n)  # -d force / d acceleration, times the supposed ones
    for i in range(n):
        for j in range(i + 1):
            matrix[i, j] = full[i + 1, j + 1]
            matrix[j, i] = full[i + 1, j + 1]
        force[i] = -bias[i + 1]
    points, speed, swing = np.zeros((n + 1, 2)), np.zeros((n + 1, 2)), np.zeros((n + 1, 2))
    columns, along = np.zeros(n), np.zeros(n)
    down_x, down_y = laws.gravity * np.sin(laws.tilt), laws.gravity * np.cos(laws.tilt)
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
        pace = long * h * slope * np.dot(columns[: i + 1], supposed[: i + 1])
        for j in range(i + 1):
            yields[j] += pace * columns[j]
            reaction[j] += long * inertia * columns[j] * ny
            for k in range(i + 1):
                matrix[j, k] += carried * columns[j] * columns[k]
        # The hinge at the link's beginning; the clamp bends over half a link.
        s = i / n if i else 0.25 / n
        unit = n if i else 2.0 * n
        second = 0.25 * np.pi * (laws.base_radius + (laws.tip_radius - laws.base_radius) * s) ** 4
        bend = unit * state[0, i + 1], unit * state[1, i + 1]
        moment, stiff = bending(laws, (s, second), bend, (memory[i], kept[i]), t, 2.0 * h)
        force[i] -= moment
        matrix[i, i] += h * stiff * unit
        yields[i] += h * stiff * unit * supposed[i]
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
    hinge = np.linalg.solve(matrix, force + yields)
    inertial = np.dot(reaction, hinge)
    for i in range(n + 1):
        inertial += masses[i] * (fixed[i] + np.dot(arms[i], hinge))
    return outside - inertial, hinge
