# pyright: reportMissingImports=false
"""The arm of arm.json as a geometric variable strain rod of SoRoMoX 0.5: needs soromox, and arm.json beside it.

    python arm_soromox.py motion.json [--out FILE.json] [--order N] [--tolerance X]

motion.json: base {t, theta, rate, acceleration} at even steps, q and q_rate (the first shape), times, s, d (places of
points), and points (T, P, 2) [m] or null: what was seen there. It prints the rms distance to what was seen.

SoRoMoX gives inertia, Coriolis forces and Jacobians. It knows neither water nor a base that moves as prescribed: the
water, the weight and the bodies at the tip come in through its Jacobians at its own quadrature points, the stiffness
and damping of arm.json are integrated over the same points, and the equations are split at the base's angle:

    M_zz z'' = forces_z - C_z - M_z0 theta'',    curvature = sum_j z_j s^j  (as many terms as the model has)

SoRoMoX's x is along the arm and its y is to the left; here x is along the normal n = (cos, sin) and y along the
straight arm t = (-sin, cos): (x, y) = (-Y, X).
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import diffrax
import jax
import jax.numpy as jnp
import numpy as np
from soromox.systems.components import JointSpec, LinearProfile, LinkSpec
from soromox.systems.gvs import GVS, GVSSegment, StrainBasisSpec

jax.config.update("jax_enable_x64", True)
SECOND_WAVE = 1.7320508075688772  # of a deep tank: frequency of its second odd standing wave over the first, sqrt(3)
POINTED = 1e-5  # m: SoRoMoX refuses a radius of zero


def rod_of(arm, order):
    """SoRoMoX's rod with a revolute joint at the clamp, `order` curvatures and its own mass."""
    section, common = arm["section"], {
        "length": arm["length"], "density": arm["density"], "reference_strain": [0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
        "young_modulus": 1e5, "poisson_ratio": 0.49,
    }  # fmt: skip
    if section["shape"] == "cone":
        ends = (max(section["base_radius"], POINTED), max(section["tip_radius"], POINTED))
        link = LinkSpec.circular(radius=LinearProfile(*ends), **common)
    else:
        link = LinkSpec.rectangular(height=section["height"], width=section["width"], **common)
    basis = StrainBasisSpec("monomial", ["kappa_z"], order - 1)
    return GVS.from_segments(
        [GVSSegment(link, JointSpec.revolute("z"), basis, 2 * order + 6)],
        gravity=jnp.zeros(3), base_pose=jnp.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]), backend="jax",
    )  # fmt: skip


def stream(water, t):
    """Velocity (2,) and acceleration (2,) of the undisturbed water in this file's frame."""
    omega = 2.0 * jnp.pi * water["slosh_f"]
    sway, surge = 0.0, 0.0
    for cos, sin, w in (("U_cos", "U_sin", omega), ("V_cos", "V_sin", SECOND_WAVE * omega)):
        sway += water[cos] * jnp.cos(w * t) + water[sin] * jnp.sin(w * t)
        surge += w * (water[sin] * jnp.cos(w * t) - water[cos] * jnp.sin(w * t))
    return jnp.array([water["U_x"] + sway, water["U_y"]]), jnp.stack([surge, 0.0 * surge])


def turned_by(base, t):
    """The base's angle, rate and acceleration at t: between two samples the quintic that has all three at both."""
    h = base[0, 1] - base[0, 0]
    k = jnp.clip(jnp.floor((t - base[0, 0]) / h).astype(int), 0, base.shape[1] - 2)
    u = (t - base[0, k]) / h
    v, v_end, a, a_end = base[2, k] * h, base[2, k + 1] * h, base[3, k] * h**2, base[3, k + 1] * h**2
    rise = base[1, k + 1] - base[1, k] - v - 0.5 * a
    gain, bend = v_end - v - a, a_end - a
    c = (10.0 * rise - 4.0 * gain + 0.5 * bend, -15.0 * rise + 7.0 * gain - bend, 6.0 * rise - 3.0 * gain + 0.5 * bend)
    angle = base[1, k] + v * u + 0.5 * a * u**2 + u**3 * (c[0] + u * (c[1] + u * c[2]))
    rate = v + a * u + u**2 * (3.0 * c[0] + u * (4.0 * c[1] + u * 5.0 * c[2]))
    return angle, rate / h, (a + u * (6.0 * c[0] + u * (12.0 * c[1] + u * 20.0 * c[2]))) / h**2


def lever(jacobian, reach, drop):
    """Rows (3, D) of a body's velocity along n, along t and about z; the body is fixed to the frame at a lever."""
    turn = jacobian[2]
    return jnp.stack([-jacobian[4] - reach * turn, jacobian[3] + drop * turn, turn])


def equations(arm, robot, order, base):
    """The state's rate for diffrax: state = (z, z') of the curvatures."""
    places = np.array(robot.integration_points[0, 1:-1])
    along = {name: jnp.array(np.interp(places, arm["along"]["s"], arm["along"][name])) for name in arm["along"]}
    weight = jnp.array(robot.inner_integration_weights[0])
    weight = weight * arm["length"] / weight.sum()
    shapes = jnp.stack([jnp.array(places) ** j for j in range(order)], axis=1)
    water, gravity, length = arm["water"], jnp.array(arm["gravity"]), jnp.array(arm["length"])
    wet = water["density"]
    across = water["C_a"] * wet * 0.25 * jnp.pi * along["width"] ** 2
    every_way = water["tangential"] * across
    turned = water["convective"] * (across - every_way)
    net = arm["density"] * along["area"] - wet * along["area"]

    def material(z, z_rate):
        """Generalised moment of bending: elasticity, its cubic law, damping."""
        curvature, rate = shapes @ z, shapes @ z_rate
        bent = curvature - along["rest_curvature"]
        moment = along["bending_stiffness"] * bent * (1.0 + along["cubic"] * bent**2)
        moment += (along["bending_damping"] + along["bending_stiffness"] * along["bent_loss"] * bent**2) * rate
        return (weight * moment) @ shapes

    def loads(robot_at, q, q_rate, t):
        """Forces (D,) without accelerations, and the mass (D, D) of water and of bodies at the tip."""
        poses, columns, turning = robot_at
        flow, surge = stream(water, t)

        def on_axes(pose, vector):
            """Components along n and t of this frame's vector."""
            cos, sin = pose[0, 0], pose[1, 0]
            return jnp.array([vector[0] * cos + vector[1] * sin, -vector[0] * sin + vector[1] * cos])

        def one(pose, jacobian, change, k):
            """Forces and mass of one quadrature point, per length."""
            rows, rates = lever(jacobian, 0.0, 0.0), lever(change, 0.0, 0.0) @ q_rate
            v_n, v_t, turn = rows @ q_rate
            flow_n, flow_t = on_axes(pose, flow)
            surge_n, surge_t = on_axes(pose, surge)
            down = on_axes(pose, gravity)
            u_n, u_t = v_n - flow_n, v_t - flow_t
            speed = jnp.sqrt(u_n**2 + u_t**2 + 1e-24)
            f_n = -(0.5 * wet * water["C_perp"] * along["width"][k] * speed + water["c_n"]) * u_n
            f_t = -(0.5 * wet * water["C_t"] * along["perimeter"][k] * speed + 0.5 * water["c_n"]) * u_t
            a_n, a_t = rates[0] - turn * v_t - surge_n, rates[1] + turn * v_n - surge_t
            f_n += -across[k] * a_n - turned[k] * turn * u_t + wet * along["area"][k] * surge_n + net[k] * down[0]
            f_t += -every_way[k] * a_t - turned[k] * turn * u_n + wet * along["area"][k] * surge_t + net[k] * down[1]
            force = jnp.array([f_n, f_t, turned[k] * u_n * u_t]) @ rows
            return force, across[k] * jnp.outer(rows[0], rows[0]) + every_way[k] * jnp.outer(rows[1], rows[1])

        forces, masses = jax.vmap(one)(poses, columns, turning, jnp.arange(len(places)))
        force, mass = weight @ forces, jnp.tensordot(weight, masses, axes=1)
        jacobian, change = robot.jacobian_and_time_derivative_bodyframe(q, q_rate, length)
        pose = robot.forward_kinematics(q, length)
        for body in arm["bodies"]:
            displaced = wet * body["volume"]
            moved = body["mass"] + arm["body_carries"] * displaced
            rows = lever(jacobian, body["reach"], body["drop"])
            rates = lever(change, body["reach"], body["drop"]) @ q_rate
            v_n, v_t, turn = rows @ q_rate
            pull = (body["mass"] - displaced) * on_axes(pose, gravity)
            pull += (1.0 + arm["body_carries"]) * displaced * on_axes(pose, surge)
            pull -= moved * jnp.array([rates[0] - turn * v_t, rates[1] + turn * v_n])
            force, mass = force + pull @ rows[:2], mass + moved * rows[:2].T @ rows[:2]
        return force, mass

    def rate(t, state, _):
        theta, theta_rate, acceleration = turned_by(base, t)
        z, z_rate = state[:order], state[order:]
        q, q_rate = jnp.concatenate([theta[None], z]), jnp.concatenate([theta_rate[None], z_rate])
        inertia, coriolis, _ = robot.dynamics_terms(q, q_rate)
        poses, columns, turning = robot.integration_kinematics(q, q_rate)
        force, mass = loads((poses[0], columns[0], turning[0]), q, q_rate, t)
        whole = inertia + mass
        right = (force - coriolis)[1:] - material(z, z_rate) - whole[1:, 0] * acceleration
        return jnp.concatenate([z_rate, jnp.linalg.solve(whole[1:, 1:], right)])

    return rate


def shown(robot, motion, base, found, arm):
    """Points (T, P, 2) [m] at the motion's times."""
    s, d = jnp.array(motion["s"]) * arm["length"], jnp.array(motion["d"])

    def one(t, z):
        q = jnp.concatenate([turned_by(base, t)[0][None], z])
        poses = robot.forward_kinematics_abscissa_batched(q, s)
        return jnp.stack([-poses[:, 1, 3] + d * poses[:, 0, 0], poses[:, 0, 3] + d * poses[:, 1, 0]], axis=-1)

    return np.array(jax.jit(jax.vmap(one))(jnp.array(motion["times"]), found))


def solver(arm, motion, order, tolerance):
    """A compiled function from the first state to the curvatures (T, order), the first state, and what shows them."""
    robot = rod_of(arm, order)
    base = jnp.array([motion["base"][name] for name in ("t", "theta", "rate", "acceleration")])
    times = jnp.array(motion["times"])
    q, q_rate = np.zeros(order), np.zeros(order)
    count = min(order, len(motion["q"]))
    q[:count], q_rate[:count] = motion["q"][:count], motion["q_rate"][:count]
    term = diffrax.ODETerm(equations(arm, robot, order, base))

    @jax.jit
    def solve(state):
        return diffrax.diffeqsolve(
            term, diffrax.Tsit5(), motion["start"], times[-1], None, state,
            saveat=diffrax.SaveAt(ts=times), max_steps=None,
            stepsize_controller=diffrax.PIDController(rtol=tolerance, atol=tolerance),
        ).ys[:, :order]  # fmt: skip

    first = jnp.concatenate([jnp.array(q), jnp.array(q_rate)]) / arm["length"]
    return solve, first, lambda found: shown(robot, motion, base, found, arm)


def simulate(arm, motion, order=None, tolerance=1e-6):
    """Points (T, P, 2) [m] of the rod at the motion's times."""
    solve, first, show = solver(arm, motion, order or arm["order"], tolerance)
    found = show(solve(first))
    if not np.isfinite(found).all():
        raise SystemExit("the rod ran away: take a smaller --tolerance")
    return found


def main():
    """Run one motion file."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("motion", type=Path)
    parser.add_argument("--out", type=Path, help="file for the points, as JSON")
    parser.add_argument("--order", type=int, help="curvatures; default: the model's")
    parser.add_argument("--tolerance", type=float, default=1e-6)
    given = parser.parse_args()
    arm = json.loads(Path(__file__).with_name("arm.json").read_text(encoding="utf-8"))
    motion = json.loads(given.motion.read_text(encoding="utf-8"))
    points = simulate(arm, motion, given.order, given.tolerance)
    if motion.get("points") is not None:
        seen = np.array(motion["points"], dtype=float)
        print(f"rms distance {1e3 * np.sqrt(np.nanmean(np.sum((points - seen) ** 2, axis=-1))):.3f} mm")
    if given.out is not None:
        given.out.write_text(json.dumps(points.tolist()), encoding="utf-8")


if __name__ == "__main__":
    main()
