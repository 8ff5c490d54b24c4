"""Forces of the water on the links, and forces at the tip, projected on the joints (compiled).

Section forces act at Gauss points of the links, so they converge with the number of links. MuJoCo's own fluid models do
not converge and have no added mass of this kind. Added mass is Kirchhoff's for a body that carries fluid along its
normal only: momentum P = m u_n n, force -dP/dt, couple -u x P (Lighthill 1960 for a slender body). With `convective`
less than 1 it is partly Morison's, the normal acceleration alone.
"""

from __future__ import annotations

import numpy as np

from mujoco_ref.chain import Chain
from mujoco_ref.section_water import beside_wall, felt_speed, shed_lift, viscous_resistance, water_motion
from mujoco_ref.step_arguments import ChainConstants, Equation, Laws
from tentacle.compiled import njit
from tentacle.signals import Array

SPHERE = 0.5  # water that a compact body carries, over that which it displaces
# Columns of the link table.
LENGTH, VOLUME, VOLUME_CENTRE, CARRIED, CARRIED_CENTRE, CARRIED_TURNING, MASS = range(7)
# Columns of the node table.
ALONG, WEIGHT, WIDTH, PERIMETER, AREA = range(5)


def link_table(chain: Chain) -> Array:
    """Per link (n + 1, 7): length, volume and its centre (its mass's too), and of pi/4 width^2: integral, centre,
    second moment about it; mass."""
    along, weight = chain.nodes(points=3)
    s = (chain.start[:, None] + along) / chain.specimen.length
    area = chain.specimen.section.area(s) * weight
    circle = 0.25 * np.pi * chain.specimen.section.width(s) ** 2 * weight
    whole = circle.sum(1)
    centre = (circle * along).sum(1) / np.where(whole > 0.0, whole, 1.0)  # a hub carries nothing
    turning = (circle * (along - centre[:, None]) ** 2).sum(1)
    volume = area.sum(1)
    volume_centre = (area * along).sum(1) / np.where(volume > 0.0, volume, 1.0)
    return np.stack([chain.length, volume, volume_centre, whole, centre, turning, chain.mass], axis=1)


def node_table(chain: Chain) -> Array:
    """Per link and Gauss point (n + 1, 2, 5): distance from the link's start, weight, width, perimeter, area."""
    along, weight = chain.nodes(points=2)
    s = (chain.start[:, None] + along) / chain.specimen.length
    section = chain.specimen.section
    return np.stack([along, weight, section.width(s), section.perimeter(s), section.area(s)], axis=2)


@njit(cache=True)
def link_motion(q: Array, v: Array, a: Array, links: Array, out: Array) -> None:
    """Per link into out (n + 2, 9): start x, y, its velocity, its acceleration, phi, its rate and acceleration.

    Row n + 1 is the tip. q, v, a (n + 3,): mount x, y, theta, hinges.
    """
    count = links.shape[0]
    x, y, vx, vy, ax, ay = q[0], q[1], v[0], v[1], a[0], a[1]
    phi, rate, acceleration = 0.0, 0.0, 0.0
    for k in range(count):
        phi, rate, acceleration = phi + q[2 + k], rate + v[2 + k], acceleration + a[2 + k]
        out[k, 0], out[k, 1], out[k, 2], out[k, 3], out[k, 4], out[k, 5] = x, y, vx, vy, ax, ay
        out[k, 6], out[k, 7], out[k, 8] = phi, rate, acceleration
        length, c, s = links[k, LENGTH], np.cos(phi), np.sin(phi)
        x, y = x - length * s, y + length * c
        vx, vy = vx - length * rate * c, vy - length * rate * s
        ax, ay = ax + length * (rate**2 * s - acceleration * c), ay - length * (rate**2 * c + acceleration * s)
    out[count, 0], out[count, 1], out[count, 2], out[count, 3], out[count, 4], out[count, 5] = x, y, vx, vy, ax, ay
    out[count, 6], out[count, 7], out[count, 8] = phi, rate, acceleration


@njit(cache=True)
def _add_tensor(
    composite: Array,
    place: tuple[float, float],
    inertia: tuple[float, float, float],
    direction: tuple[float, float],
) -> None:
    """Add a normal and a tangential inertia (or resistance) at a place, and one against turning, to the composite.

    composite: S0 = sum T (xx, xy, yy), S1 = sum T p' (x, y), S2 = sum p'T p' + turning, with p' = (-y, x).
    direction: cosine and sine of the section's angle.
    """
    x, y = place
    a_n, a_t, turning = inertia
    c, s = direction
    xx, xy, yy = a_n * c * c + a_t * s * s, (a_n - a_t) * c * s, a_n * s * s + a_t * c * c
    wx, wy = -xx * y + xy * x, -xy * y + yy * x
    composite[0] += xx
    composite[1] += xy
    composite[2] += yy
    composite[3] += wx
    composite[4] += wy
    composite[5] += -y * wx + x * wy + turning


@njit(cache=True)
def water_forces(
    motion: Array, body: ChainConstants, laws: Laws, t: float, half_step: float, equation: Equation
) -> None:
    """Add the water's generalised force to force (n + 3,), and to matrix (n + 3, n + 3) its added mass plus
    half_step times its resistance: what an implicit step needs. Writes sums.

    motion as from link_motion, with the predicted accelerations. The reaction of the added mass to them is in force;
    the matrix gives the reaction to their correction.
    """
    links, nodes, bodies = body.links, body.nodes, body.bodies
    water, tip = laws.water[0], laws.tip[0]
    force, matrix, sums = equation.force, equation.matrix, equation.sums
    count = links.shape[0]
    composite = np.zeros(6)
    wet = water.density > 0.0 or water.c_n != 0.0  # a viscous resistance may be air's
    fx, fy, moment = 0.0, 0.0, 0.0
    sums[:] = 0.0
    end = motion[count]
    # Forces at the tip: a thread (tension only), a magnet beside the tank.
    if tip.thread_stiffness != 0.0:
        dx, dy = tip.thread_x - end[0], tip.thread_y - end[1]
        distance = np.sqrt(dx * dx + dy * dy)
        pull = tip.thread_stiffness * max(0.0, distance - tip.thread_slack) / max(distance, 1e-9)
        sums[2] += pull * dx
        sums[3] += pull * dy
    if tip.magnet_strength != 0.0:
        dx, dy = tip.magnet_x - end[0], tip.magnet_y - end[1]
        # The 5 mm keep the pull finite where the tip passes over the magnet.
        pull = tip.magnet_strength / (dx * dx + dy * dy + 2.5e-5) ** 1.5
        sums[2] += pull * dx
        sums[3] += pull * dy
    if water.shed != 0.0 and water.density > 0.0:
        # Water that leaves a tip with an edge takes its momentum with it: Lighthill 1971.
        wx, wy, _, _ = water_motion(end[0], end[1], t, water)
        ux, uy, c, s = end[2] - wx, end[3] - wy, np.cos(end[6]), np.sin(end[6])
        u_n, u_t = ux * c + uy * s, -ux * s + uy * c
        carried = 0.25 * np.pi * water.density * water.shed**2
        leaves = min(u_t, 0.0)  # a tip that leads meets water at rest
        f_n, f_t = carried * u_n * leaves, -0.5 * carried * u_n * u_n
        sums[0] += f_n * c - f_t * s
        sums[1] += f_n * s + f_t * c
        _add_tensor(composite, (end[0], end[1]), (-half_step * carried * leaves, 0.0, 0.0), (c, s))
    fx, fy = sums[0] + sums[2], sums[1] + sums[3]
    moment = end[0] * fy - end[1] * fx
    if water.density > 0.0:
        c, s, rate, acceleration = np.cos(end[6]), np.sin(end[6]), end[7], end[8]
        for k in range(bodies.shape[0]):
            displaced = water.density * bodies[k, 3]
            if displaced == 0.0:
                continue
            # A compact body: buoyancy, the swaying water's pressure, and the water that it carries.
            px, py = bodies[k, 2] * c - bodies[k, 1] * s, bodies[k, 2] * s + bodies[k, 1] * c
            ax = end[4] - acceleration * py - rate**2 * px
            ay = end[5] + acceleration * px - rate**2 * py
            px, py = end[0] + px, end[1] + py
            _, _, wax, way = water_motion(px, py, t, water)
            carries = SPHERE * displaced
            flow_x, flow_y = (displaced + carries) * wax, (displaced + carries) * way
            sums[0] += flow_x
            sums[1] += flow_y
            gx, gy = -displaced * water.gravity_x, -displaced * water.gravity_y
            sums[2] += gx
            sums[3] += gy
            gx, gy = gx + flow_x - carries * ax, gy + flow_y - carries * ay
            fx, fy, moment = fx + gx, fy + gy, moment + px * gy - py * gx
            _add_tensor(composite, (px, py), (carries, carries, 0.0), (c, s))
    for k in range(count - 1, -1, -1):
        x0, y0, vx0, vy0, ax0, ay0, phi, rate, acceleration = motion[k]
        c, s = np.cos(phi), np.sin(phi)
        if wet:
            volume, reach = links[k, VOLUME], links[k, VOLUME_CENTRE]
            px, py = x0 - reach * s, y0 + reach * c
            bx, by = -water.density * volume * water.gravity_x, -water.density * volume * water.gravity_y
            sums[2] += bx
            sums[3] += by
            fx, fy, moment = fx + bx, fy + by, moment + px * by - py * bx
            # Drag at the Gauss points (eq. 15), relative to the water.
            resist_n, resist_t, resist_x, resist_xx = 0.0, 0.0, 0.0, 0.0
            for g in range(nodes.shape[1]):
                reach, weight, width = nodes[k, g, ALONG], nodes[k, g, WEIGHT], nodes[k, g, WIDTH]
                px, py = x0 - reach * s, y0 + reach * c
                wx, wy, wax, way = water_motion(px, py, t, water)
                ux, uy = vx0 - reach * rate * c - wx, vy0 - reach * rate * s - wy
                u_n, u_t = ux * c + uy * s, -ux * s + uy * c
                speed = np.sqrt(u_n * u_n + u_t * u_t)
                C_perp, squeezed, wall_n, wall_t = water.C_perp, 0.0, 0.0, 0.0
                if water.wall_B != 0.0:
                    more, squeezed, wall_n, wall_t = beside_wall(px, 0.5 * width, (c, s), (u_n, u_t), water)
                    C_perp += more
                felt = felt_speed(speed, u_n, width, C_perp, water)
                across = 0.5 * water.density * C_perp * width
                skin = 0.5 * water.density * water.C_t * nodes[k, g, PERIMETER]
                slow = water.c_n + viscous_resistance(width, water)
                f_n = wall_n - (across * felt + slow) * u_n
                if water.lift_cos != 0.0 or water.lift_sin != 0.0:
                    f_n += shed_lift(width, t, water)
                f_t = wall_t - (skin * speed + 0.5 * water.c_n) * u_t
                if water.vortex_C_L != 0.0:
                    beat = np.sin(2.0 * np.pi * water.vortex_f * t)
                    f_n += 0.5 * water.density * width * water.vortex_C_L * speed**2 * beat
                # Froude-Krylov: the pressure gradient that accelerates the water also acts on the body in its place.
                displaced = water.density * nodes[k, g, AREA]
                gx, gy = weight * (f_n * c - f_t * s + displaced * wax), weight * (f_n * s + f_t * c + displaced * way)
                sums[0] += gx
                sums[1] += gy
                fx, fy, moment = fx + gx, fy + gy, moment + px * gy - py * gx
                if squeezed != 0.0:
                    ax = ax0 + reach * (rate**2 * s - acceleration * c) - wax
                    ay = ay0 - reach * (rate**2 * c + acceleration * s) - way
                    f_n = -weight * squeezed * (ax * c + ay * s + rate * u_t)
                    f_t = -weight * squeezed * rate * u_n
                    gx, gy = f_n * c - f_t * s, f_n * s + f_t * c
                    fx, fy = fx + gx, fy + gy
                    moment += px * gy - py * gx + weight * squeezed * u_n * u_t
                    _add_tensor(composite, (px, py), (weight * squeezed, 0.0, 0.0), (c, s))
                slope = weight * (2.0 * across * speed + slow)
                resist_n += slope
                resist_t += weight * (2.0 * skin * speed + 0.5 * water.c_n)
                resist_x += slope * reach
                resist_xx += slope * reach * reach
            if resist_n > 0.0:
                reach = resist_x / resist_n
                turning = half_step * (resist_xx - resist_n * reach * reach)
                px, py = x0 - reach * s, y0 + reach * c
                _add_tensor(composite, (px, py), (half_step * resist_n, half_step * resist_t, turning), (c, s))
            if water.C_a != 0.0:
                carried = water.C_a * water.density * links[k, CARRIED]
                turning = water.C_a * water.density * links[k, CARRIED_TURNING]
                reach = links[k, CARRIED_CENTRE]
                px, py = x0 - reach * s, y0 + reach * c
                wx, wy, wax, way = water_motion(px, py, t, water)
                ux, uy = vx0 - reach * rate * c - wx, vy0 - reach * rate * s - wy
                ax = ax0 + reach * (rate**2 * s - acceleration * c) - wax
                ay = ay0 - reach * (rate**2 * c + acceleration * s) - way
                u_n, u_t, a_n, a_t = ux * c + uy * s, -ux * s + uy * c, ax * c + ay * s, -ax * s + ay * c
                # Carried every way, it is mass: -m a. Carried along the normal alone,
                # -d/dt(m u_n n) = -m [(a_n + rate u_t) n + rate u_n t]; couple -u x P = m u_n u_t. Morison's is
                # -m a_n n alone: `turned` is the mass whose other terms act.
                round_it = water.tangential * carried
                turned = water.convective * (carried - round_it)
                f_n, f_t = -carried * a_n - turned * rate * u_t, -turned * rate * u_n - round_it * a_t
                gx, gy = f_n * c - f_t * s, f_n * s + f_t * c
                fx, fy = fx + gx, fy + gy
                moment += px * gy - py * gx + turned * u_n * u_t - turning * acceleration
                _add_tensor(composite, (px, py), (carried, round_it, turning), (c, s))
        force[2 + k] += moment - (x0 * fy - y0 * fx)
        if wet:
            # Rows of the composite's matrix for the joint at (x0, y0): arms p' = (-y, x).
            sx, sy = composite[3], composite[4]
            rx, ry = -composite[0] * y0 + composite[1] * x0, -composite[1] * y0 + composite[2] * x0
            own = -y0 * sx + x0 * sy
            for j in range(k + 1):
                xj, yj = motion[j, 0], motion[j, 1]
                entry = composite[5] - own + yj * (sx - rx) - xj * (sy - ry)
                matrix[2 + k, 2 + j] += entry
                if j != k:
                    matrix[2 + j, 2 + k] += entry
            for axis in range(2):
                entry = (sx - rx) if axis == 0 else (sy - ry)
                matrix[2 + k, axis] += entry
                matrix[axis, 2 + k] += entry
    force[0] += fx
    force[1] += fy
    matrix[0, 0] += composite[0]
    matrix[0, 1] += composite[1]
    matrix[1, 0] += composite[1]
    matrix[1, 1] += composite[2]
