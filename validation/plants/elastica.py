"""PyElastica's Cosserat rod in the tank: it bends, shears and stretches. It needs PyElastica installed.

PyElastica gives the rod's strains and its internal forces f and torques m. With v of the nodes, w of the elements:
M_water dv = h (f + water + weight), (J + h/2 D) dw = h (m + material + couples), positions half a step before and after
(position Verlet, damping by the trapezoidal rule). Difference from the rod of point masses, in 22 mm of motion: .15 mm
for a bare arm (shear), 3 to 4 % for its load; .3 to 3.5 % of the change by added mass, payload, soft spot or
memory. It shares no code with the project's two models.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from tentacle.compiled import njit
from tentacle.errors import InputError
from tentacle.signals import Array
from validation.plants.draw import Trial
from validation.plants.filmed import COARSE, Plant
from validation.plants.material import BRANCHES, bending
from validation.plants.tank import on_piece

PIECES = 32
STEP = 5e-5  # s, at most: waves of shear and stretch cross no more than a third of a piece
GRIP = 0.3  # share of the largest stable explicit dashpot: stretch and shear vibrate faster than a camera can show


def plant(_: Trial) -> Plant:
    """The trial's rod: every trial has the same pieces and steps. InputError where PyElastica is not installed."""
    try:
        usable = hasattr(
            import_module("elastica"), "CosseratRod"
        )  # an uninstalled one leaves a folder of caches behind
    except ImportError:
        usable = False
    if not usable:
        expected = 'one of the other plants, or: pip install "tentacle-twin[elastica]"'
        raise InputError("PyElastica is not installed", field="elastica", expected=expected)
    return Plant(move, COARSE, {"pieces": PIECES, "step_s": STEP})


def move(laws: np.ndarray, theta: Array, step: float, every: int) -> tuple[Array, Array]:
    """As filmed.Mover: places (T, PIECES + 1, 2) [m], and the force along y on the mount [N].

    FloatingPointError where the rod runs away.
    """
    law, rod = laws[0], _rod(laws[0])
    parts = int(np.ceil(step / STEP - 1e-9))
    h = step / parts
    steps = (theta.size - 1) // 2
    base = CubicSpline(0.5 * step * np.arange(theta.size), theta)
    middles = h * (np.arange(steps * parts) + 0.5)
    angles, turnings = base(middles), base(middles, 1)
    n = PIECES
    x, v = rod.position_collection[:2].copy(), np.zeros((2, n + 1))
    phi, w = np.full(n, theta[0]), np.zeros(n)
    x[:] = _straight(rod.rest_lengths, theta[0])
    memory = np.zeros((n, BRANCHES + 1))
    fixed = (rod.mass, rod.mass_second_moment_of_inertia[0, 0], rod.rest_lengths, rod.radius)
    places, pulls, pull = [x.T.copy()], [], 0.0
    for k in range(steps * parts):
        _drift(x, v, phi, w, 0.5 * h, rod.director_collection)
        rod.position_collection[:2], rod.velocity_collection[:2], rod.omega_collection[0] = x, v, w
        rod.compute_internal_forces_and_torques(middles[k])
        inner = (rod.internal_forces[:2], rod.internal_torques[0])
        pull = _kick(law, fixed, (x, v, phi, w), inner, memory, (angles[k], turnings[k], middles[k], h))
        _drift(x, v, phi, w, 0.5 * h, rod.director_collection)
        if k % (every * parts) == 0:
            pulls.append(pull)
        if (k + 1) % (every * parts) == 0:
            places.append(x.T.copy())
    pulls.append(pull)
    found = np.array(places)
    if not np.isfinite(found).all():
        raise FloatingPointError("the rod ran away: take a smaller step")
    return found, np.array(pulls)[: len(found)]


def _rod(law: np.void) -> Any:
    elastica: Any = import_module("elastica")
    middles = (np.arange(PIECES) + 0.5) / PIECES
    modulus = float(law["E"])
    return elastica.CosseratRod.straight_rod(
        PIECES, np.zeros(3), np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]), float(law["length"]),
        law["base_radius"] + (law["tip_radius"] - law["base_radius"]) * middles,
        float(law["density"] * (1.0 + law["heavier"])), youngs_modulus=modulus, shear_modulus=modulus / 3.0,
    )  # fmt: skip


def _straight(lengths: Array, angle: float) -> Array:
    far = np.concatenate([[0.0], np.cumsum(lengths)])
    return np.stack([-far * np.sin(angle), far * np.cos(angle)])


@njit(cache=True)
def _drift(x: Array, v: Array, phi: Array, w: Array, h: float, directors: Array) -> None:
    """Places and angles after h at these rates, and PyElastica's directors (its first stands on the plane)."""
    x += h * v
    phi += h * w
    for i in range(phi.size):
        cos, sin = np.cos(phi[i]), np.sin(phi[i])
        directors[1, 0, i], directors[1, 1, i] = cos, sin
        directors[2, 0, i], directors[2, 1, i] = -sin, cos


@njit(cache=True)
def _dashpots(law, fixed, moving, force: Array, torque: Array, h: float) -> None:
    """Dashpots of stretch and shear, as strong as is stable with an explicit step h."""
    _, _, lengths, radius = fixed
    x, v, phi, w = moving
    density = law.density * (1.0 + law.heavier)
    for i in range(phi.size):
        nx, ny = np.cos(phi[i]), np.sin(phi[i])
        tx, ty = -ny, nx
        bx, by = x[0, i + 1] - x[0, i], x[1, i + 1] - x[1, i]
        rx, ry = v[0, i + 1] - v[0, i] + by * w[i], v[1, i + 1] - v[1, i] - bx * w[i]
        area = np.pi * radius[i] ** 2
        along = GRIP * density * area * lengths[i] / (4.0 * h) * (rx * tx + ry * ty)
        slow = min(lengths[i] ** 2 / 4.0, radius[i] ** 2 / 4.0)
        across = GRIP * density * area * slow / (lengths[i] * h) * (rx * nx + ry * ny)
        fx, fy = along * tx + across * nx, along * ty + across * ny
        force[0, i] += fx
        force[1, i] += fy
        force[0, i + 1] -= fx
        force[1, i + 1] -= fy
        torque[i] += bx * fy - by * fx


@njit(cache=True)
def _kick(law, fixed, moving, inner, memory: Array, now):
    """Rates after a step, in place; the force along y on the mount [N]. now: base angle, its rate, time, step."""
    mass, inertia, lengths, radius = fixed
    x, v, phi, w = moving
    angle, turning, t, h = now
    n = phi.size
    force, torque = inner[0].copy(), inner[1].copy()
    _dashpots(law, fixed, moving, force, torque, h)
    carried = np.zeros((3, n + 1))  # xx, xy, yy of the water's mass at a node
    down_x, down_y = law.gravity * np.sin(law.tilt), law.gravity * np.cos(law.tilt)
    for i in range(n):
        nx, ny = np.cos(phi[i]), np.sin(phi[i])
        ux, uy = 0.5 * (v[0, i] + v[0, i + 1]), 0.5 * (v[1, i] + v[1, i + 1])
        place = (0.5 * (x[0, i] + x[0, i + 1]), 0.5 * (x[1, i] + x[1, i + 1]), nx, ny)
        push_n, push_t, couple, water, _ = on_piece(law, ((i + 0.5) / n, radius[i]), place, (ux, uy, 0.0, 0.0), w[i], t)
        sunk = law.density * (1.0 + law.heavier) - law.water * (1.0 + law.saltier)
        net = sunk * np.pi * radius[i] ** 2
        fx = 0.5 * lengths[i] * (push_n * nx - push_t * ny + net * down_x)
        fy = 0.5 * lengths[i] * (push_n * ny + push_t * nx + net * down_y)
        torque[i] += lengths[i] * couple
        for node in (i, i + 1):
            force[0, node] += fx
            force[1, node] += fy
            carried[0, node] += 0.5 * lengths[i] * water * nx * nx
            carried[1, node] += 0.5 * lengths[i] * water * nx * ny
            carried[2, node] += 0.5 * lengths[i] * water * ny * ny
    over, kept = np.zeros(n), np.zeros(BRANCHES + 1)
    for i in range(n):
        span = 0.5 * lengths[0] if i == 0 else 0.5 * (lengths[i - 1] + lengths[i])
        s = i / n if i else 0.25 / n  # the clamp bends over half a piece
        second = 0.25 * np.pi * (law.base_radius + (law.tip_radius - law.base_radius) * s) ** 4
        turn, rate = phi[i] - (phi[i - 1] if i else angle), w[i] - (w[i - 1] if i else turning)
        unit = law.length / span
        moment, stiff = bending(law, (s, second), (unit * turn, unit * rate), (memory[i], kept), t, h)
        for j in range(kept.size):
            memory[i, j] = 2.0 * kept[j] - memory[i, j]
        over[i] = 0.5 * h * stiff * unit
        if i:
            moment -= law.E * second * turn / span  # PyElastica's own
            torque[i - 1] += moment
        torque[i] -= moment
    # The tip: payload on its lever, magnet, thread.
    nx, ny = np.cos(phi[n - 1]), np.sin(phi[n - 1])
    lever_x, lever_y = law.payload_drop * nx - law.payload_reach * ny, law.payload_drop * ny + law.payload_reach * nx
    heavy = law.payload * (1.0 + 0.5 * law.water / law.payload_density)
    weight = law.payload * (1.0 - law.water / law.payload_density)
    hang_x = weight * down_x + heavy * w[n - 1] ** 2 * lever_x
    hang_y = weight * down_y + heavy * w[n - 1] ** 2 * lever_y
    torque[n - 1] += lever_x * hang_y - lever_y * hang_x
    dx, dy = law.magnet_x - x[0, n], law.magnet_y - x[1, n]
    draw = law.magnet / (dx * dx + dy * dy + 2.5e-5) ** 1.5
    wx, wy = law.anchor_x - x[0, n], law.anchor_y - x[1, n]
    far = np.sqrt(wx * wx + wy * wy)
    taut = law.thread * max(0.0, far - law.slack) / max(far, 1e-9)
    force[0, n] += hang_x + draw * dx + taut * wx
    force[1, n] += hang_y + draw * dy + taut * wy
    # Nodes: 2 x 2 blocks; the last has the payload on its lever, whose rotation is eliminated from the elements'
    # system.
    xx = xy = yy = gx = gy = 0.0
    determinant = 1.0
    for i in range(1, n + 1):
        own = mass[i] + (heavy if i == n else 0.0)
        xx, xy, yy = own + carried[0, i], carried[1, i], own + carried[2, i]
        determinant = xx * yy - xy * xy
        gx, gy = (
            (yy * force[0, i] - xy * force[1, i]) / determinant,
            (xx * force[1, i] - xy * force[0, i]) / determinant,
        )
        v[0, i] += h * gx
        v[1, i] += h * gy
    sx, sy = -heavy * lever_y, heavy * lever_x
    px, py = (yy * sx - xy * sy) / determinant, (xx * sy - xy * sx) / determinant
    diagonal, right = inertia.copy(), h * torque
    diagonal[n - 1] += heavy * (lever_x**2 + lever_y**2) - (sx * px + sy * py)
    right[n - 1] -= h * (sx * gx + sy * gy)
    for i in range(n):
        diagonal[i] += over[i] + (over[i + 1] if i + 1 < n else 0.0)
    for i in range(1, n):  # Thomas' elimination; off the diagonal stands -over
        share = over[i] / diagonal[i - 1]
        diagonal[i] -= share * over[i]
        right[i] += share * right[i - 1]
    change = right[n - 1] / diagonal[n - 1]
    v[0, n] -= px * change
    v[1, n] -= py * change
    w[n - 1] += change
    for i in range(n - 2, -1, -1):
        change = (right[i] + over[i + 1] * change) / diagonal[i]
        w[i] += change
    return force[1, 0]
