"""The water's forces on a piece of the arm, per length; each by two or more published laws.

n is the piece's normal, t its tangent towards the tip; spin is the rate of its angle phi, t = (-sin phi, cos phi).
"""

from __future__ import annotations

import numpy as np

from tentacle.compiled import njit

SECOND_MODE = 1.732  # of a deep tank's odd standing waves, over the first: omega^2 = g n pi / l
TOUCH = 0.2  # of a radius: nearer than this a wall's laws are not evaluated


@njit(cache=True)
def water_at(laws, y: float, t: float):
    """Velocity and acceleration of the undisturbed water along x; a steady one along y."""
    profile = 1.0
    if laws.current_law == 1.0:  # the 1/7 power of a turbulent boundary layer on the plate that holds the clamp
        profile = (min(max(y, 1e-4) / laws.length, 1.0)) ** (1.0 / 7.0)
    u, a = laws.U_x * profile, 0.0
    if laws.U_cos != 0.0 or laws.U_sin != 0.0:
        w = 2.0 * np.pi * laws.slosh_f
        first = 1.0 if laws.sloshing_law == 0.0 else 0.75
        u += first * (laws.U_cos * np.cos(w * t) + laws.U_sin * np.sin(w * t))
        a += first * w * (laws.U_sin * np.cos(w * t) - laws.U_cos * np.sin(w * t))
        if laws.sloshing_law == 1.0:
            w *= SECOND_MODE
            u += 0.4 * (laws.U_sin * np.cos(w * t) + laws.U_cos * np.sin(w * t))
            a += 0.4 * w * (laws.U_cos * np.cos(w * t) - laws.U_sin * np.sin(w * t))
    return u, a, laws.U_y * profile


@njit(cache=True)
def wall_growth(laws, x: float, radius: float) -> float:
    """Relative growth of the drag near a wall: DNV-RP-F105's curve of the gap in diameters, or (radius/distance)^2."""
    distance = abs(laws.wall_x - x)
    gap = max(distance - radius, TOUCH * radius) / (2.0 * radius)
    if laws.wall_law != 1.0:
        return laws.wall_B * 0.5 / (1.0 + 5.0 * gap)
    return laws.wall_B * (radius / max(distance, radius)) ** 2


@njit(cache=True)
def wall_inertia(laws, x: float, radius: float):
    """Additional added mass per length near a wall, along the normal, and its derivative along x: potential flow
    round a cylinder and its image, m = rho pi r^2 (r / distance)^2 / 2 to first order (Brennen 1982).
    """
    away = laws.wall_x - x
    near = max(abs(away), radius)
    mass = laws.wall_B * 0.5 * laws.water * np.pi * radius**4 / near**2
    return mass, 2.0 * mass / away if abs(away) > radius else 0.0


@njit(cache=True)
def on_piece(laws, section, place, motion, spin: float, t: float):
    """Force per length along n and t, couple, the inertia that it carries along n, and how fast its force falls with
    the speed along n. section: s and radius; place: x, y and the normal; motion: velocity and acceleration."""
    s, radius = section
    x, y, nx, ny = place
    vx, vy, ax, ay = motion
    if laws.water == 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    tx, ty = -ny, nx
    wind, surge, rise = water_at(laws, y, t)
    ux, uy = vx - wind, vy - rise
    u_n, u_t = ux * nx + uy * ny, ux * tx + uy * ty
    speed = np.sqrt(u_n * u_n + u_t * u_t)
    coefficient = laws.C_perp
    if laws.wall_B != 0.0:
        coefficient *= 1.0 + wall_growth(laws, x, radius)
    across = laws.water * coefficient * radius  # half the density on the diameter
    slow = laws.c_n if laws.linear_drag_law == 0.0 else laws.c_n * radius / (0.5 * (laws.base_radius + laws.tip_radius))
    push_n = -(across * speed + slow) * u_n
    skin = laws.water * laws.C_t * np.pi * radius
    push_t = -(skin * (speed if laws.skin_drag_law == 0.0 else abs(u_t)) + laws.tangent * slow) * u_t
    slope = 2.0 * across * speed + slow
    if laws.vortex != 0.0:
        push_n += laws.water * radius * laws.vortex * speed * speed * np.sin(2.0 * np.pi * laws.vortex_f * t)
    displaced = laws.water * np.pi * radius * radius
    push_n += displaced * surge * nx
    push_t += displaced * surge * tx
    couple, inertia = 0.0, 0.0
    if laws.C_a != 0.0:
        inertia = laws.C_a * displaced
        if laws.added_mass_law >= 2.0:  # water escapes round the free end: half as much in the last diameter
            inertia *= 1.0 - 0.5 * max(0.0, 1.0 - (1.0 - s) * laws.length / (2.0 * radius))
        push_n -= inertia * ((ax - surge) * nx + ay * ny)
        if laws.added_mass_law == 0.0 or laws.added_mass_law == 2.0:  # d/dt of the momentum inertia u_n n (Kirchhoff)
            push_n -= inertia * spin * u_t
            push_t -= inertia * spin * u_n
            couple = inertia * u_n * u_t
    if laws.wall_B != 0.0 and laws.wall_law == 2.0:
        more, growth = wall_inertia(laws, x, radius)
        lift = 0.5 * growth * u_n * u_n
        push_n -= more * ((ax - surge) * nx + ay * ny + spin * u_t) + growth * ux * u_n - lift * nx
        push_t += lift * tx - more * spin * u_n
        couple += more * u_n * u_t
        inertia += more
    return push_n, push_t, couple, inertia, slope
