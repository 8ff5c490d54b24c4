# pyright: reportMissingImports=false
"""The arm of arm.json as a Cosserat rod of PyElastica 1.0: needs pyelastica, and arm.json beside it.

    python arm_pyelastica.py motion.json [--out FILE.json] [--elements N] [--step SECONDS]

motion.json: base {t, theta, rate, acceleration}, q and q_rate (the first shape), times, s, d (places of points), and
points (T, P, 2) [m] or null: what was seen there. It prints the rms distance to what was seen.

The rod has its own bending, shear and stretch; the arm that was identified does neither shear nor stretch, so its
stretch is made STIFFER times the material's. A joint of the rod stands half an element beyond the clamp, as the clamped
element reaches half its length below it: second order in the elements' length.

PyElastica gives the internal forces before it asks for external ones. So the forces here contain the accelerations that
added mass (along the normal alone), bodies on a lever at the tip and Kelvin-Voigt damping lead to, exactly:

    (m + m_a n n) a = f,    (J + h/2 C) dw/dt = tau - C w,    C: the damping between neighbouring elements

Base frame: x along the normal n = (cos, sin), y along the straight arm t = (-sin, cos).
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import elastica
import numpy as np
from elastica.boundary_conditions import ConstraintBase
from elastica.external_forces import NoForces
from numba import njit
from scipy.interpolate import CubicSpline

STIFFER = 10.0  # stretch stiffness over the material's
POISSON = 0.5  # silicone keeps its volume
SAFETY = 0.25  # of the largest stable step
NAMES = ("density", "C_perp", "C_t", "C_a", "tangential", "convective", "c_n",
         "U_x", "U_y", "U_cos", "U_sin", "V_cos", "V_sin", "slosh_f")  # fmt: skip
SECOND_WAVE = 1.7320508075688772  # of a deep tank: frequency of its second odd standing wave over the first, sqrt(3)


class Simulator(elastica.BaseSystemCollection, elastica.Constraints, elastica.Forcing):
    """One rod with a constraint and forces."""


class Clamp(ConstraintBase):
    """The first element turns about the origin as the base does."""

    def __init__(self, first, second, director, base, half, **kwargs):  # PyElastica hands over what it constrains
        super().__init__(first, second, director, **kwargs)
        self.base, self.half = base, half

    def constrain_values(self, system, time):
        """Places and directors of the first element."""
        angle = np.interp(time, self.base[0], self.base[1])
        along = np.array([-np.sin(angle), np.cos(angle)])
        system.position_collection[:2, 0] = -self.half * along
        system.position_collection[:2, 1] = self.half * along
        system.director_collection[1, :2, 0] = along[1], -along[0]
        system.director_collection[2, :2, 0] = along

    def constrain_rates(self, system, time):
        """Their rates."""
        angle, rate = np.interp(time, self.base[0], self.base[1]), np.interp(time, self.base[0], self.base[2])
        normal = np.array([np.cos(angle), np.sin(angle)])
        system.velocity_collection[:2, 0] = self.half * rate * normal
        system.velocity_collection[:2, 1] = -self.half * rate * normal
        system.omega_collection[:, 0] = rate, 0.0, 0.0


@njit
def stream(water, t):
    """Velocity (2,) and acceleration along x of the undisturbed water."""
    omega = 2.0 * np.pi * water[13]
    faster = SECOND_WAVE * omega
    sway = water[9] * np.cos(omega * t) + water[10] * np.sin(omega * t)
    sway += water[11] * np.cos(faster * t) + water[12] * np.sin(faster * t)
    surge = omega * (water[10] * np.cos(omega * t) - water[9] * np.sin(omega * t))
    surge += faster * (water[12] * np.cos(faster * t) - water[11] * np.sin(faster * t))
    return water[7] + sway, water[8], surge


@njit
def surround(numbers, moving, inner, outer, t):
    """Forces (2, n + 1) and couples (n,) of water, weight, tip bodies and damping, into outer."""
    water, gravity, elements, joints, tip, alpha_0, h = numbers
    v, w, directors, mass, turning, dilatation = moving
    n = w.shape[0]
    spacing = elements[0, 0]
    force, torque = inner[0].copy(), inner[1].copy()
    carried = np.zeros((3, n + 1))
    U_x, U_y, surge = stream(water, t)
    for k in range(n):
        width, perimeter, area, own, solid = elements[1:6, k]
        nx, ny = directors[1, 0, k], directors[1, 1, k]
        ux, uy = 0.5 * (v[0, k] + v[0, k + 1]) - U_x, 0.5 * (v[1, k] + v[1, k + 1]) - U_y
        u_n, u_t = ux * nx + uy * ny, -ux * ny + uy * nx
        speed = np.sqrt(u_n * u_n + u_t * u_t)
        f_n = -(0.5 * water[0] * water[1] * width * speed + water[6]) * u_n
        f_t = -(0.5 * water[0] * water[2] * perimeter * speed + 0.5 * water[6]) * u_t
        across = water[3] * water[0] * 0.25 * np.pi * width * width
        every_way = water[4] * across
        turned = water[5] * (across - every_way)
        f_n += across * surge * nx - turned * w[k] * u_t
        f_t += -every_way * surge * ny - turned * w[k] * u_n
        torque[k] += spacing * turned * u_n * u_t
        net = (own - water[0] * solid) * spacing
        fx = spacing * (f_n * nx - f_t * ny + water[0] * area * surge) + net * gravity[0]
        fy = spacing * (f_n * ny + f_t * nx) + net * gravity[1]
        for node in (k, k + 1):
            force[0, node] += 0.5 * fx
            force[1, node] += 0.5 * fy
            half = 0.5 * spacing
            carried[0, node] += half * (across * nx * nx + every_way * ny * ny)
            carried[1, node] += half * (across - every_way) * nx * ny
            carried[2, node] += half * (across * ny * ny + every_way * nx * nx)
    nx, ny = directors[1, 0, n - 1], directors[1, 1, n - 1]
    heavy = sx = sy = turn = 0.0
    for b in range(tip.shape[0]):
        own, displaced, reach, drop, share = tip[b]
        m = own + share * displaced
        lx, ly = drop * nx - reach * ny, drop * ny + reach * nx
        fx = (own - displaced) * gravity[0] + m * w[n - 1] ** 2 * lx + (1.0 + share) * displaced * surge
        fy = (own - displaced) * gravity[1] + m * w[n - 1] ** 2 * ly
        force[0, n] += fx
        force[1, n] += fy
        torque[n - 1] += lx * fy - ly * fx
        heavy, sx, sy, turn = heavy + m, sx - m * ly, sy + m * lx, turn + m * (lx * lx + ly * ly)
    # Damping between neighbours, and more of it where the arm is bent; then one system for all turning.
    diagonal, damping = turning.copy(), np.zeros(n)
    for k in range(n - 1):
        cosine = directors[1, 0, k] * directors[1, 0, k + 1] + directors[1, 1, k] * directors[1, 1, k + 1]
        sine = directors[1, 0, k] * directors[1, 1, k + 1] - directors[1, 1, k] * directors[1, 0, k + 1]
        bend = np.arctan2(sine, cosine) / spacing - joints[3, k]
        damping[k] = (joints[1, k] + joints[0, k] * joints[4, k] * bend * bend) / spacing
        moment = damping[k] * (w[k + 1] - w[k]) + joints[0, k] * joints[2, k] * bend**3
        torque[k] += moment
        torque[k + 1] -= moment
        diagonal[k] += 0.5 * h * damping[k]
        diagonal[k + 1] += 0.5 * h * damping[k]
    a = np.zeros((2, n + 1))
    determinant = xx = xy = yy = 1.0
    for i in range(n + 1):
        own = mass[i] + (heavy if i == n else 0.0)
        xx, xy, yy = own + carried[0, i], carried[1, i], own + carried[2, i]
        determinant = xx * yy - xy * xy
        a[0, i] = (yy * force[0, i] - xy * force[1, i]) / determinant
        a[1, i] = (xx * force[1, i] - xy * force[0, i]) / determinant
    px, py = (yy * sx - xy * sy) / determinant, (xx * sy - xy * sx) / determinant
    diagonal[n - 1] += turn - (sx * px + sy * py)
    torque[n - 1] -= sx * a[0, n] + sy * a[1, n]
    # Thomas' elimination; off the diagonal stands -h/2 damping. The clamped element's acceleration is known.
    diagonal[0], torque[0] = 1.0, alpha_0
    for k in range(1, n):
        share = 0.5 * h * damping[k - 1] / diagonal[k - 1]
        torque[k] += share * torque[k - 1]
        if k > 1:
            diagonal[k] -= share * 0.5 * h * damping[k - 1]
    alpha = np.zeros(n)
    alpha[n - 1] = torque[n - 1] / diagonal[n - 1]
    for k in range(n - 2, 0, -1):
        alpha[k] = (torque[k] + 0.5 * h * damping[k] * alpha[k + 1]) / diagonal[k]
    a[0, n] -= px * alpha[n - 1]
    a[1, n] -= py * alpha[n - 1]
    for i in range(n + 1):
        outer[0][0, i] = mass[i] * a[0, i] - inner[0][0, i]
        outer[0][1, i] = mass[i] * a[1, i] - inner[0][1, i]
    for k in range(n):
        outer[1][0, k] = turning[k] * alpha[k] / dilatation[k] - inner[1][k]


class Surroundings(NoForces):
    """Everything outside of the rod's own elasticity."""

    def __init__(self, numbers, base, step):
        super().__init__()
        self.numbers, self.base, self.step = numbers, base, step

    def apply_forces(self, system, time=0.0):
        """Forces and couples at once: bodies on a lever couple the two."""
        numbers = (*self.numbers, np.interp(time, self.base[0], self.base[3]), self.step)
        moving = (system.velocity_collection, system.omega_collection[0], system.director_collection, system.mass,
                  system.mass_second_moment_of_inertia[0, 0], system.dilatation)  # fmt: skip
        inner = (system.internal_forces, system.internal_torques[0])
        surround(numbers, moving, inner, (system.external_forces, system.external_torques), time)


def rod_of(arm, elements):
    """The straight rod of an arm, its first element's middle at the origin; and its spacing [m]."""
    along = {name: np.array(values) for name, values in arm["along"].items()}
    spacing = arm["length"] / (elements - 0.5)
    places = np.arange(elements) * spacing / arm["length"]  # of the elements' middles
    joints = (np.arange(elements - 1) + 0.5) * spacing / arm["length"]

    def at(name, s):
        return np.interp(s, along["s"], along[name])

    area, second = at("area", places), at("second_moment", places)
    modulus = float(along["bending_stiffness"][0] / along["second_moment"][0])
    rod = elastica.CosseratRod.straight_rod(
        elements, np.array([0.0, -0.5 * spacing, 0.0]), np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]),
        elements * spacing, np.sqrt(area / np.pi), arm["density"], youngs_modulus=modulus,
        shear_modulus=modulus / (2.0 * (1.0 + POISSON)),
    )  # fmt: skip
    turning = arm["density"] * second * spacing
    rod.mass_second_moment_of_inertia[0, 0] = turning
    rod.inv_mass_second_moment_of_inertia[0, 0] = 1.0 / turning
    rod.bend_matrix[0, 0] = at("bending_stiffness", joints)
    rod.rest_kappa[0] = at("rest_curvature", joints)
    rod.shear_matrix[2, 2] *= STIFFER
    per_element = [np.full(elements, spacing), at("width", places), at("perimeter", places), area,
                   arm["density"] * area, area]  # fmt: skip
    per_joint = [at(name, joints) for name in ("bending_stiffness", "bending_damping", "cubic", "rest_curvature",
                                               "bent_loss")]  # fmt: skip
    return rod, spacing, np.array(per_element), np.array(per_joint)


def stable_step(rod, spacing):
    """A share of the largest stable step [s]: shear turns an element, stretch moves its ends."""
    shear = rod.shear_matrix[0, 0] * spacing
    fastest = np.sqrt(shear / rod.mass_second_moment_of_inertia[0, 0]).max()
    light = rod.mass[1:]
    stretch = 2.0 * np.sqrt(rod.shear_matrix[2, 2] / spacing / np.minimum(light, np.roll(light, 1))).max()
    sideways = 2.0 * np.sqrt(rod.shear_matrix[0, 0] / spacing / np.minimum(light, np.roll(light, 1))).max()
    return SAFETY * 2.0 / max(np.hypot(fastest, sideways), stretch)


def bend(rod, motion, base, length, spacing):
    """Put the rod into the motion's first shape, at its first rates."""
    n = rod.n_elems
    s = np.arange(n) * spacing / length
    theta, rate = np.interp(motion["start"], base[0], base[1]), np.interp(motion["start"], base[0], base[2])
    angle, turn = np.full(n, theta), np.full(n, rate)
    for j, (q, q_rate) in enumerate(zip(motion["q"], motion["q_rate"], strict=True)):
        angle, turn = angle + q * s ** (j + 1) / (j + 1), turn + q_rate * s ** (j + 1) / (j + 1)
    steps, moved = np.stack([-np.sin(angle), np.cos(angle)]), -turn * np.stack([np.cos(angle), np.sin(angle)])
    first = -0.5 * spacing * steps[:, :1]
    rod.position_collection[:2] = np.concatenate([first, first + spacing * np.cumsum(steps, axis=1)], axis=1)
    first = -0.5 * spacing * moved[:, :1]
    rod.velocity_collection[:2] = np.concatenate([first, first + spacing * np.cumsum(moved, axis=1)], axis=1)
    rod.director_collection[1, 0], rod.director_collection[1, 1] = np.cos(angle), np.sin(angle)
    rod.director_collection[2, 0], rod.director_collection[2, 1] = -np.sin(angle), np.cos(angle)
    rod.omega_collection[0] = turn


def shown(rod, s, d, spacing, length):
    """Points (P, 2) [m] of the rod at places s along it and d [m] beside it, from its tangents' angles."""
    angle = np.unwrap(np.arctan2(rod.director_collection[1, 1], rod.director_collection[1, 0]))
    phi = CubicSpline(np.arange(rod.n_elems) * spacing / length, angle, bc_type=("not-a-knot", "natural"))  # pyright: ignore[reportArgumentType]
    fine = np.linspace(0.0, 1.0, 401)
    middles = phi(0.5 * (fine[1:] + fine[:-1]))
    steps = length / 400.0 * np.stack([-np.sin(middles), np.cos(middles)])
    line = np.concatenate([np.zeros((2, 1)), np.cumsum(steps, axis=1)], axis=1)
    on = np.stack([np.interp(s, fine, line[0]), np.interp(s, fine, line[1])], axis=-1)
    return on + d[:, None] * np.stack([np.cos(phi(s)), np.sin(phi(s))], axis=-1)


def simulate(arm, motion, elements=20, step=None):
    """Points (T, P, 2) [m] of the rod at the motion's times."""
    rod, spacing, per_element, per_joint = rod_of(arm, elements)
    base = np.array([motion["base"][name] for name in ("t", "theta", "rate", "acceleration")])
    bend(rod, motion, base, arm["length"], spacing)
    h = step or stable_step(rod, spacing)
    water = np.array([arm["water"][name] for name in NAMES])
    wet = arm["water"]["density"]
    tip = np.array([[body["mass"], wet * body["volume"], body["reach"], body["drop"], arm["body_carries"]]
                    for body in arm["bodies"]]).reshape(-1, 5)  # fmt: skip
    numbers = (water, np.array(arm["gravity"]), per_element, per_joint, tip)
    simulator = Simulator()
    simulator.append(rod)
    simulator.constrain(rod).using(
        Clamp, constrained_position_idx=(0, 1), constrained_director_idx=(0,), base=base, half=0.5 * spacing
    )
    simulator.add_forcing_to(rod).using(Surroundings, numbers, base, h)
    simulator.finalize()
    stepper, t = elastica.PositionVerlet(), motion["start"]
    s, d, found = np.array(motion["s"]), np.array(motion["d"]), []
    for wanted in motion["times"]:
        while t < wanted - 1e-12:
            t = float(stepper.step(simulator, np.float64(t), np.float64(min(h, wanted - t))))
        found.append(shown(rod, s, d, spacing, arm["length"]))
    if not np.isfinite(found).all():
        raise SystemExit(f"the rod ran away: take a shorter --step than {h:.2g} s")
    return np.array(found)


def main():
    """Run one motion file."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("motion", type=Path)
    parser.add_argument("--out", type=Path, help="file for the points, as JSON")
    parser.add_argument("--elements", type=int, default=20)
    parser.add_argument("--step", type=float, help="s; default: a share of the largest stable one")
    given = parser.parse_args()
    arm = json.loads(Path(__file__).with_name("arm.json").read_text(encoding="utf-8"))
    motion = json.loads(given.motion.read_text(encoding="utf-8"))
    points = simulate(arm, motion, given.elements, given.step)
    if motion.get("points") is not None:
        seen = np.array(motion["points"], dtype=float)
        print(f"rms distance {1e3 * np.sqrt(np.nanmean(np.sum((points - seen) ** 2, axis=-1))):.3f} mm")
    if given.out is not None:
        given.out.write_text(json.dumps(points.tolist()), encoding="utf-8")


if __name__ == "__main__":
    main()
