"""A hull that floats freely: its equations against scipy, conservation laws, energy, and the rail as their limit."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from affine_model.advance import Drive, Pace, Rail, Servo, advance, at_rest
from affine_model.arm import Arm, active_effects, parameter_index
from affine_model.dynamics import Instant, balance
from affine_model.free_body import Hull
from tentacle.errors import InputError
from tentacle.specimen import AIR, WATER, Cone, Gravity, Specimen
from tentacle.waveform import Sine

ARM = Arm(Specimen(Cone(0.0125, 0.003), 0.14, 1070.0), WATER, Gravity(0.0, 0.0), order=2, nodes=8)
N = ARM.order
HULL = Hull(0.3, 3e-4, 0.1, 0.05, 3.0, 1.0, 1e-4, 1e-4)
BARE = Hull(0.3, 3e-4)
WAVE = Sine(0.6, 1.3)
WATERY = {"elasticity__E": 2e5, "damping__eta": 2e3, "drag__C_perp": 1.1, "added_mass__C_a": 0.9, "skin_drag__C_t": 0.1}
# z, theta, y, x and their rates: bent, turning and drifting
START = np.array([0.2, -0.1, 0.0, 0.01, -0.02]), np.array([0.5, 0.3, 2.0, 0.02, -0.05])


def run(p, hull, timing, arm=ARM, waveform=WAVE, start=START):
    """States and rates (K + 1, D), and the servo's torque (K,); timing: step and duration [s]."""
    h, seconds = timing
    drive, steps = Drive(hull=hull), round(seconds / h)
    base = waveform((np.arange(steps) + 0.5) * h)[:, :, None]
    state = at_rest(arm, 1, drive)
    state.u[:, 0], state.u_rate[:, 0] = start
    state.u[N] += waveform(0.0)[0]  # yaw is START's theta
    course = advance(arm, drive, p[:, None], base, (np.zeros(1), state), Pace(h, 1, iterations=3))
    assert course.summary[4, 0] < 0.0
    return course.u[:, :, 0], course.u_rate[:, :, 0], course.force[:, 3, 0]


def hull_force(hull, command, u, v, water):
    """On theta, y, x, by the equations at the head of affine_model.free_body, along the hull's axes as vectors."""
    psi, rate = u[N] - command[0], v[N] - command[1]
    across, along = np.array([np.cos(psi), np.sin(psi)]), np.array([-np.sin(psi), np.cos(psi)])
    w = np.array([v[N + 2], v[N + 1]]) - water
    drag = (hull.viscous_across + hull.drag_across * abs(w @ across)) * (w @ across) * across
    drag = drag + (hull.viscous_along + hull.drag_along * abs(w @ along)) * (w @ along) * along
    against = (hull.yaw_viscous + hull.yaw_drag * abs(rate)) * rate
    return np.array([hull.yaw_inertia * command[2] - against, -drag[1], -drag[0]])


def reference(p, hull, seconds, water):
    effects, size = active_effects(p), N + 3

    def rate(t, state):
        u, v = state[:size], state[size:]
        b = balance(ARM, effects, p, u, v, Instant(t))
        M, F = b.mass_matrix.copy(), b.force.copy()
        M[range(N, size), range(N, size)] += [hull.yaw_inertia, hull.mass, hull.mass]
        F[N:] += hull_force(hull, WAVE(t), u, v, water)
        return np.concatenate([v, np.linalg.solve(M, F)])

    u, v = (part.copy() for part in START)
    u[N] += WAVE(0.0)[0]
    found = solve_ivp(rate, (0, seconds), [*u, *v], method="DOP853", rtol=1e-9, atol=1e-11, max_step=4e-3)
    return found.y[:, -1]


@pytest.mark.parametrize(
    ("more", "water"),
    [({}, (0.0, 0.0)), ({"tip_mass__mass": 0.004, "current__U_x": 0.03, "current__U_y": -0.02}, (0.03, -0.02))],
)
def test_the_kernel_moves_the_hull_as_the_assembly_says(parameters, more, water):
    p, seconds = parameters(**WATERY, **more), 0.25
    truth = reference(p, HULL, seconds, np.array(water))
    coarse, fine = (np.concatenate([part[-1] for part in run(p, HULL, (h, seconds))[:2]]) for h in (1 / 4000, 1 / 8000))
    scale = np.array([1, 1, 1, 0.1, 0.1, 20, 20, 20, 2, 2])
    # Second order: Richardson's value is right to what scipy and a third order leave.
    assert np.max(np.abs((4 * fine - coarse) / 3 - truth) / scale) < 2e-6
    assert np.max(np.abs(fine - truth) / scale) < 1e-4


def momenta(arm, p, hull, u, v, command_rate):
    """Momentum x, y [kg m/s] and angular momentum about the tank's origin [kg m^2/s], (K,) each."""
    b = balance(arm, active_effects(p), p, u, v)
    own = np.einsum("tij,tj->ti", b.mass_matrix, v)
    y, x, y_rate, x_rate = u[:, N + 1], u[:, N + 2], v[:, N + 1], v[:, N + 2]
    p_x, p_y = own[:, N + 2] + hull.mass * x_rate, own[:, N + 1] + hull.mass * y_rate
    spin = own[:, N] + x * p_y - y * p_x + hull.yaw_inertia * (v[:, N] - command_rate)
    return p_x, p_y, spin


@pytest.mark.parametrize("tip", [0.0, 0.006])
def test_momentum_and_angular_momentum_stay_without_water(parameters, tip):
    # The servo, elasticity and damping act inside: nothing changes the whole's momentum. What changes it is the step's
    # error, of second order: it falls fourfold with half the step, and Richardson's value is a thousandth of it.
    arm, p = replace(ARM, fluid=AIR), parameters(elasticity__E=2e5, damping__eta=2e3, tip_mass__mass=tip)
    found = {}
    for h in (1 / 1000, 1 / 2000):
        u, v, _ = run(p, BARE, (h, 2.0), arm)
        command = WAVE(h * np.arange(len(u)))
        found[h] = np.array([part[:: round(1 / 1000 / h)] for part in momenta(arm, p, BARE, u, v, command[1])])
    size = np.array([0.35 * 0.5, 0.35 * 0.5, 1.5e-3])[:, None]  # of what moves back and forth
    coarse, fine = (np.max(np.abs(f - f[:, :1]) / size) for f in found.values())
    better = (4.0 * found[1 / 2000] - found[1 / 1000]) / 3.0
    assert fine < 1e-3
    assert coarse / fine == pytest.approx(4.0, rel=0.1)
    assert np.max(np.abs(better - better[:, :1]) / size) < 1e-3 * fine + 1e-7


def test_the_servo_gives_what_motion_keeps_and_drag_takes(parameters):
    # Work of the servo = energy gained (with that of the carried water) + lost to the water, the material and the hull.
    p, seconds, left = parameters(**WATERY), 1.5, []
    effects = active_effects(p)
    still = p.copy()
    still[[parameter_index("elasticity", "E"), parameter_index("added_mass", "C_a")]] = 0.0
    for h in (1 / 2000, 1 / 4000):
        u, v, torque = run(p, HULL, (h, seconds))
        middle, rate = 0.5 * (u[1:] + u[:-1]), 0.5 * (v[1:] + v[:-1])
        command = WAVE((np.arange(len(middle)) + 0.5) * h)
        ends = [0, -1]
        M = balance(ARM, effects, p, u[ends], v[ends]).mass_matrix
        yaw_rate = v[ends, N] - WAVE(h * np.array([0, len(middle)]))[1]
        kinetic = 0.5 * np.einsum("ti,tij,tj->t", v[ends], M, v[ends])
        kinetic += 0.5 * HULL.mass * np.sum(v[ends, N + 1 :] ** 2, axis=1) + 0.5 * HULL.yaw_inertia * yaw_rate**2
        bent = u[ends, :N] @ ARM.curvature_basis.T
        stiffness = 2e5 * ARM.node_quantities["second_moment"] / ARM.specimen.length
        elastic = 0.5 * np.einsum("i,i,ti->t", ARM.rule.weights, stiffness, bent**2)
        # What damps: the forces at rates alone, without stiffness; those of the arm's own turning do no work.
        forces = balance(ARM, tuple(e for e in effects if e.dissipative), still, middle, rate).force
        lost = -np.sum(forces * rate, axis=1)
        given = np.array(
            [hull_force(HULL, [c[0], c[1], 0.0], q, w, 0.0) for c, q, w in zip(command.T, middle, rate, strict=True)]
        )
        lost -= given[:, 0] * (rate[:, N] - command[1]) + given[:, 1] * rate[:, N + 1] + given[:, 2] * rate[:, N + 2]
        work = h * np.sum(torque * command[1])
        left.append(work - np.diff(kinetic + elastic)[0] - h * np.sum(lost))
    assert abs(left[1]) < 1e-3 * work
    assert abs((4.0 * left[1] - left[0]) / 3.0) < 2e-5 * work


def test_without_yaw_and_drift_it_is_the_rail(parameters):
    # Yaw inertia and drag across without bound: the rail is left. A prescribed angle and one that the hull's inertia
    # carries differ by the step's error, which falls fourfold; 1e-6 (rad, m) is left at 1/4000 s.
    p, seconds, left = parameters(**WATERY), 2.0, []
    rail = Rail(mass=0.25, viscous=0.35)
    bound = Hull(0.25, 1e6, viscous_across=1e8, viscous_along=0.35)
    ready, still = Sine(0.6, 1.3, np.pi / 2), np.zeros(N + 3)  # begins with no rate
    for h in (1 / 2000, 1 / 4000):
        base = ready((np.arange(round(seconds / h)) + 0.5) * h)[:, :, None]
        state = at_rest(ARM, 1, Drive(rail=rail))
        state.u[N] = ready(0.0)[0]
        course = advance(ARM, Drive(rail=rail), p[:, None], base, (np.zeros(1), state), Pace(h, 1, iterations=3))
        u, _, _ = run(p, bound, (h, seconds), waveform=ready, start=(still, still))
        left.append(np.max(np.abs(u[:, : N + 2] - course.u[:, :, 0])))
    assert left[1] < 1e-6
    assert left[0] / left[1] == pytest.approx(4.0, rel=0.2)
    assert np.ptp(u[:, N + 1]) > 1e-2  # it moved


def test_left_and_right_are_alike(parameters):
    p = parameters(**WATERY)
    one, other = (
        run(p, HULL, (1 / 500, 2.0), waveform=wave, start=(np.zeros(N + 3), np.zeros(N + 3)))[0]
        for wave in (WAVE, Sine(0.6, 1.3, np.pi))
    )
    mirror = np.array([-1.0] * N + [-1.0, 1.0, -1.0])
    np.testing.assert_allclose(one, mirror * other, atol=1e-9)


def test_many_lanes_are_as_one(parameters):
    p = parameters(**WATERY)
    drive, count = Drive(hull=HULL), 21
    base = WAVE((np.arange(200) + 0.5) / 500)[:, :, None]
    many = np.repeat(p[:, None], count, axis=1)
    whole = advance(ARM, drive, many, base, (np.zeros(count), at_rest(ARM, count, drive)), Pace(1 / 500, 10))
    alone = advance(ARM, drive, p[:, None], base, (np.zeros(1), at_rest(ARM, 1, drive)), Pace(1 / 500, 10))
    np.testing.assert_allclose(whole.u, np.repeat(alone.u, count, axis=2), atol=1e-12)


def test_an_impossible_hull_is_refused():
    with pytest.raises(InputError, match="mass"):
        Hull(0.0, 1e-4)
    with pytest.raises(InputError, match="drag_along"):
        Hull(0.1, 1e-4, drag_along=-1.0)
    with pytest.raises(InputError, match="neither rail"):
        Drive(rail=Rail(0.2), hull=HULL)
    with pytest.raises(InputError, match="neither rail"):
        Drive(servo=Servo(1.0, 0.0, 1.0), hull=HULL)
