"""A stranger's simulator: a planar elastic rod of point masses, stretching and bending, stepped explicitly.

It shares nothing with the project's models: no curvature coordinates, no chain of hinges, no common law. Forces as
someone would write them down who has an arm in a tank: a spring and a dashpot for every length and every angle, drag on
every piece, weight less buoyancy. x points to the side, y along the hanging arm.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from tentacle.signals import Array

PIECES, STEP = 26, 1.8e-6  # 0.03 mm from twice as many; the largest stable step
GRAVITY = 9.80665


@dataclass(frozen=True)
class Rod:
    """An arm and its water, and what may be hidden in it: lengths [m], densities [kg/m^3], E [Pa], eta [Pa s], current
    and sloshing [m/s], frequency [Hz], tip_mass [kg], linear_drag [kg/(m s)], cubic [1/rad^2], bent [rad] (curvature at
    rest), branch [Pa] with its time [s], tilt [rad], heavier: density of the water, in parts, drift [1/s], friction:
    share of E I that slips at a curvature of 0.2 rad; carried: water along with the arm in all directions, over that of
    the arm's volume.
    """

    length: float = 0.15
    base_radius: float = 0.011
    tip_radius: float = 0.003
    density: float = 1080.0
    water: float = 1000.0
    E: float = 2.2e5
    eta: float = 1500.0
    C_perp: float = 1.1
    current: float = 0.0
    sloshing: float = 0.0
    frequency: float = 0.7
    tip_mass: float = 0.0
    linear_drag: float = 0.0
    cubic: float = 0.0
    bent: float = 0.0
    branch: float = 0.0
    branch_time: float = 0.2
    tilt: float = 0.0
    heavier: float = 0.0
    drift: float = 0.0
    friction: float = 0.0
    carried: float = 0.0


def move(rod: Rod, theta: Array, step: float, every: int) -> Array:
    """Positions (T, PIECES + 1, 2) [m] at every `every`-th of the base angles theta (S,) [rad], which are a step [s]
    apart. FloatingPointError where it runs away.
    """
    share = (np.arange(PIECES) + 0.5) / PIECES
    radius = rod.base_radius + (rod.tip_radius - rod.base_radius) * share
    joints = np.arange(PIECES) / PIECES
    joints[0] = 0.25 / PIECES  # the clamp bends over half a piece
    second = 0.25 * np.pi * (rod.base_radius + (rod.tip_radius - rod.base_radius) * joints) ** 4
    piece = rod.length / PIECES
    area = np.pi * radius**2
    mass, water = np.zeros(PIECES + 1), np.zeros(PIECES + 1)
    for end in (0, 1):
        mass[end : PIECES + end] += 0.5 * rod.density * area * piece
        water[end : PIECES + end] += 0.5 * rod.carried * rod.water * area * piece
    mass[-1] += rod.tip_mass
    weight = (rod.density - rod.water * (1.0 + rod.heavier)) * area * piece * GRAVITY
    spans = np.full(PIECES, piece)
    spans[0] *= 0.5
    numbers = np.array([
        rod.E, rod.eta, rod.water * rod.C_perp * piece, rod.current, rod.sloshing, 2 * np.pi * rod.frequency,
        rod.linear_drag * piece, rod.cubic * rod.length**2, rod.bent / rod.length, rod.branch, rod.branch_time,
        rod.drift, rod.friction, 0.2 / rod.length, rod.tip_mass * GRAVITY, np.sin(rod.tilt), np.cos(rod.tilt),
    ])  # fmt: skip
    places = _moved(numbers, mass + water, radius, area, second, spans, weight, piece, theta, step, every)
    if not np.isfinite(places).all():
        raise FloatingPointError("the rod ran away: take a smaller step")
    return places


@numba.njit(cache=True, fastmath=False)
def _moved(numbers, mass, radius, area, second, spans, weight, piece, theta, step, every):
    (E, eta, drag, current, sloshing, omega, linear, cubic, bent, branch, branch_time, drift, friction, slip,
     hung, down_x, down_y) = numbers  # fmt: skip
    n = radius.size
    x, v, force = np.zeros((n + 1, 2)), np.zeros((n + 1, 2)), np.zeros((n + 1, 2))
    x[:, 0], x[:, 1] = -piece * np.arange(n + 1) * np.sin(theta[0]), piece * np.arange(n + 1) * np.cos(theta[0])
    remembered, held = np.zeros(n), np.zeros(n)
    found = np.zeros(((theta.size - 1) // every + 1, n + 1, 2))
    for k in range(theta.size - 1):
        if k % every == 0:
            found[k // every] = x
        t = k * step
        stiff = E * (1.0 - drift * t)
        wind = current + sloshing * np.sin(omega * t)
        force[:] = 0.0
        for i in range(n):
            along_x, along_y = x[i + 1, 0] - x[i, 0], x[i + 1, 1] - x[i, 1]
            long = np.sqrt(along_x**2 + along_y**2)
            along_x, along_y = along_x / long, along_y / long
            apart = (v[i + 1, 0] - v[i, 0]) * along_x + (v[i + 1, 1] - v[i, 1]) * along_y
            pull = area[i] * (E * (long - piece) + eta * apart) / piece
            u_x, u_y = 0.5 * (v[i, 0] + v[i + 1, 0]) - wind, 0.5 * (v[i, 1] + v[i + 1, 1])
            across = u_x * along_y - u_y * along_x
            push = -(drag * radius[i] * np.sqrt(u_x**2 + u_y**2) + linear) * across
            half_x = 0.5 * (push * along_y + weight[i] * down_x)
            half_y = 0.5 * (-push * along_x + weight[i] * down_y)
            force[i, 0] += pull * along_x + half_x
            force[i, 1] += pull * along_y + half_y
            force[i + 1, 0] += half_x - pull * along_x
            force[i + 1, 1] += half_y - pull * along_y
        force[n, 0] += hung * down_x
        force[n, 1] += hung * down_y
        for i in range(n):  # the joint below piece i; the clamp's direction stands for a piece before the first
            b_x, b_y = x[i + 1, 0] - x[i, 0], x[i + 1, 1] - x[i, 1]
            square_b = b_x**2 + b_y**2
            turn_bx, turn_by = -b_y / square_b, b_x / square_b
            rate = turn_bx * (v[i + 1, 0] - v[i, 0]) + turn_by * (v[i + 1, 1] - v[i, 1])
            if i == 0:
                a_x, a_y, turn_ax, turn_ay = -np.sin(theta[k]), np.cos(theta[k]), 0.0, 0.0
                rate -= (theta[k + 1] - theta[k]) / step
            else:
                a_x, a_y = x[i, 0] - x[i - 1, 0], x[i, 1] - x[i - 1, 1]
                square_a = a_x**2 + a_y**2
                turn_ax, turn_ay = -a_y / square_a, a_x / square_a
                rate -= turn_ax * (v[i, 0] - v[i - 1, 0]) + turn_ay * (v[i, 1] - v[i - 1, 1])
            bend = np.arctan2(a_x * b_y - a_y * b_x, a_x * b_x + a_y * b_y) / spans[i]
            rate /= spans[i]
            moment = stiff * (bend - bent) * (1.0 + cubic * bend**2) + eta * rate
            remembered[i] += step * (rate - remembered[i] / branch_time)
            held[i] = min(max(held[i] + step * rate, -slip), slip)
            moment = second[i] * (moment + branch * remembered[i] + friction * stiff * held[i])
            force[i + 1, 0] -= moment * turn_bx
            force[i + 1, 1] -= moment * turn_by
            if i > 0:
                force[i, 0] += moment * (turn_bx + turn_ax)
                force[i, 1] += moment * (turn_by + turn_ay)
                force[i - 1, 0] -= moment * turn_ax
                force[i - 1, 1] -= moment * turn_ay
        for i in range(1, n + 1):
            for axis in range(2):
                v[i, axis] += step * force[i, axis] / mass[i]
                x[i, axis] += step * v[i, axis]
    found[-1] = x
    return found
