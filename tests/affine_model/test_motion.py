"""Motions of the compiled kernel against conservation laws and closed solutions."""

import numpy as np
import pytest

from affine_model.advance import Drive
from affine_model.arm import Arm
from affine_model.modes import modes
from affine_model.simulate import Rail, Servo, Start, Timing, simulate
from tentacle.specimen import AIR, WATER, Cone, Fluid, Gravity, Rectangle, Specimen

CONE = Specimen(Cone(0.0125, 0.001), 0.14, 1070.0)
STILL = np.zeros((3, 1, 1))


def energy(arm, p, q, q_rate):
    """Kinetic (by the mass matrix, proved in test_dynamics) + elastic + weight [J], for q (T, n)."""
    from affine_model.arm import active_effects
    from affine_model.dynamics import balance

    L, rule, section = arm.specimen.length, arm.rule, arm.specimen.section
    z, z_rate = q @ arm.from_monomial.T, q_rate @ arm.from_monomial.T
    zeros = np.zeros((len(z), 2))
    u, v = np.concatenate([z, zeros], 1), np.concatenate([z_rate, zeros], 1)
    M = balance(arm, active_effects(p), p, u, v).mass_matrix
    kinetic = 0.5 * np.einsum("ti,tij,tj->t", v, M, v)
    k = 2e5 * section.second_moment(rule.s) / L
    elastic = 0.5 * (z @ arm.curvature_basis.T) ** 2 @ (rule.weights * k)
    phi = z @ arm.angle_basis.T
    position = L * np.stack([-np.sin(phi), np.cos(phi)], -1).transpose(0, 2, 1) @ rule.integration.T
    g = arm.gravity.magnitude * np.array([np.sin(arm.gravity.angle), np.cos(arm.gravity.angle)])
    weight = -L * (rule.weights * arm.specimen.density * section.area(rule.s)) @ (g @ position).T
    return kinetic + elastic + weight, kinetic


@pytest.mark.parametrize("order", [2, 3])
def test_energy_is_constant_over_ten_seconds(parameters, order):
    # Implicit midpoint, time-reversible: the energy error stays bounded, and falls with the square of the step.
    arm = Arm(CONE, AIR, Gravity(0.3), order=order, nodes=8)
    p = parameters(elasticity__E=2e5)
    q0 = np.zeros((order, 1))
    q0[0] = 0.3
    h = 1 / 8000
    batch = simulate(
        arm, p[:, None], np.repeat(STILL, round(10 / h), 1), Timing(h, 800, iterations=2), start=Start(q=q0)
    )
    total, kinetic = energy(arm, p, batch.q[..., 0], batch.q_rate[..., 0])
    exchanged = kinetic.max()
    assert exchanged > 1e-5  # joule: it does move
    assert np.max(np.abs(total - total[0])) < 1e-6 * exchanged  # measured: 2e-7 at this step


def test_added_mass_in_all_directions_only_rescales_an_arm(parameters):
    # (rho_s + C_a rho_w) x'' = forces: the same motion as with all forces divided by 1 + C_a rho_w / rho_s. So such
    # water can be told neither from a softer arm nor, under gravity, from a wrong density (effect buoyancy).
    arm, h = Arm(CONE, WATER, Gravity(magnitude=0.0), order=2, nodes=8), 1 / 1000
    t = h * (np.arange(2000) + 0.5)
    w = 2 * np.pi * 1.2
    base = 0.4 * np.stack([np.sin(w * t), w * np.cos(w * t), -(w**2) * np.sin(w * t)])[:, :, None]
    share = 1.0 / (1.0 + 0.8 * WATER.density / CONE.density)
    carried = parameters(elasticity__E=2e5, damping__eta=2e3, drag__C_perp=1.1, added_mass__C_a=0.8,
                         added_mass__tangential=1.0)  # fmt: skip
    softer = parameters(elasticity__E=2e5 * share, damping__eta=2e3 * share, drag__C_perp=1.1 * share)
    one, other = (simulate(arm, p[:, None], base, Timing(h)).q[..., 0] for p in (carried, softer))
    assert np.ptp(one[:, 0]) > 0.2
    # Left: rotary inertia, which the water has none of: (r / L)^2 / 4, some thousandths of the motion.
    np.testing.assert_allclose(one, other, atol=2e-3 * np.ptp(one[:, 1]))
    along_normal = parameters(elasticity__E=2e5, damping__eta=2e3, drag__C_perp=1.1, added_mass__C_a=0.8)
    assert np.max(np.abs(simulate(arm, along_normal[:, None], base, Timing(h)).q[..., 0] - other)) > 5e-3


def test_terminal_speed_on_the_rail(parameters):
    # A rigid straight arm held across the rail (theta = 90 degrees) sinks along y: drag 1/2 rho C_perp A v^2 balances
    # the weight.
    arm = Arm(Specimen(Rectangle(0.02, 0.01), 0.2, 1070.0), WATER, Gravity(0.0), order=2)
    p = parameters(elasticity__E=1e9, damping__eta=1e6, drag__C_perp=1.25)
    h, steps = 0.01, 2000
    base = np.zeros((3, steps, 1))
    base[0] = np.pi / 2
    batch = simulate(arm, p[:, None], base, Timing(h, steps), drive=Drive(rail=Rail(mass=0.1, slip_speed=1.0)))
    net = (1070 - 998) * 0.02 * 0.01 * 0.2 * arm.gravity.magnitude
    # 1e-4: the arm, stiff as it is, bends a little.
    assert batch.rail_rate[-1, 0] == pytest.approx(np.sqrt(net / (0.5 * 998 * 1.25 * 0.02 * 0.2)), rel=1e-4)


def test_quadratic_drag_slows_as_one_over_time(parameters):
    # m v' = -b v^2: 1/v = 1/v0 + b t / m. Here through a stiff arm across the rail, started by the current: seen from
    # the water, that moves at U past an arm at rest, the arm's speed is U - v. 2e-3: the arm bends.
    arm = Arm(Specimen(Rectangle(0.02, 0.01), 0.2, 1070.0), Fluid(998.0), Gravity(0.0, 0.0), order=2)
    U, h, steps = 0.3, 0.005, 2000
    p = parameters(elasticity__E=1e9, damping__eta=1e6, drag__C_perp=1.25, current__U_y=U)
    base = np.zeros((3, steps, 1))
    base[0] = np.pi / 2
    batch = simulate(arm, p[:, None], base, Timing(h, 100), drive=Drive(rail=Rail(mass=0.1, slip_speed=1.0)))
    mass, b = 0.1 + arm.specimen.mass, 0.5 * 998 * 1.25 * 0.02 * 0.2
    np.testing.assert_allclose(1 / (U - batch.rail_rate[1:, 0]), 1 / U + b * batch.t[1:] / mass, rtol=2e-3)


def test_momentum_on_a_frictionless_rail(parameters):
    # In air, no gravity along y: whatever the base does, the carriage and the arm share no net momentum.
    arm = Arm(CONE, AIR, Gravity(0.0, 0.0), order=2, nodes=8)
    p = parameters(elasticity__E=2e5, damping__eta=500.0)
    h, steps = 1 / 4000, 4000
    t = (np.arange(steps) + 0.5) * h
    ramp = 0.5 * (1 - np.cos(np.pi * t)) ** 2  # starts at rest
    base = np.stack([ramp, np.gradient(ramp, h), np.gradient(np.gradient(ramp, h), h)])[:, :, None]
    q0 = np.array([[0.8], [-0.3]])
    batch = simulate(
        arm,
        p[:, None],
        base,
        Timing(h, 40, iterations=3),
        start=Start(q=q0),
        drive=Drive(rail=Rail(mass=0.05, slip_speed=1.0)),
    )
    from affine_model.arm import active_effects
    from affine_model.dynamics import balance

    z, z_rate = batch.q[..., 0] @ arm.from_monomial.T, batch.q_rate[..., 0] @ arm.from_monomial.T
    u = np.concatenate([z, batch.theta, batch.rail], 1)
    v = np.concatenate([z_rate, batch.theta_rate, batch.rail_rate], 1)
    M = balance(arm, active_effects(p), p, u, v).mass_matrix
    momentum = np.einsum("tj,tj->t", M[:, -1], v) + 0.05 * v[:, -1]
    scale = 0.05 * np.max(np.abs(v[:, -1]))
    assert scale > 1e-3
    # Second order in the step: 1e-4 of the carriage's own momentum at 4 kHz.
    assert np.max(np.abs(momentum)) < 1e-4 * scale


def test_free_decay_rings_at_the_mode_s_frequency(parameters):
    arm = Arm(CONE, AIR, Gravity(0.0, 0.0), order=2, nodes=8)
    p = parameters(elasticity__E=2e5)
    found = modes(arm, p)
    h, steps = 1 / 2000, 8000
    q0 = 0.01 * found.shapes[:, :1] / found.shapes[0, 0]
    batch = simulate(arm, p[:, None], np.repeat(STILL, steps, 1), Timing(h), start=Start(q=q0))
    q1 = batch.q[:, 0, 0]
    crossings = np.flatnonzero((q1[:-1] < 0) & (q1[1:] >= 0))
    exact = batch.t[crossings] - q1[crossings] * h / (q1[crossings + 1] - q1[crossings])
    period = (exact[-1] - exact[0]) / (len(exact) - 1)
    # The midpoint rule's own lag, (omega h)^2 / 12 = 2e-5, and the amplitude of 0.01 rad.
    assert 1 / period == pytest.approx(found.frequency[0], rel=1e-4)


def test_torque_limit_is_reached_and_kept(parameters):
    arm = Arm(CONE, WATER, order=2)
    p = parameters(elasticity__E=2e5, damping__eta=1e3, drag__C_perp=1.1)
    base = np.zeros((3, 500, 1))
    base[0] = 0.8  # a step command: the servo starts there, so turn the command at once
    base[0, 10:] = -0.8
    servo = Servo(stiffness=5.0, damping=0.05, torque_limit=0.02)
    batch = simulate(arm, p[:, None], base, Timing(1 / 500), drive=Drive(servo=servo))
    assert np.max(np.abs(batch.torque)) == pytest.approx(0.02, rel=1e-12)
    assert np.mean(np.isclose(np.abs(batch.torque), 0.02)) > 0.05
    unlimited = simulate(arm, p[:, None], base, Timing(1 / 500), drive=Drive(servo=Servo(5.0, 0.05, 10.0)))
    assert np.max(np.abs(unlimited.torque)) > 0.1


def test_a_diverging_individual_says_when_and_disturbs_no_other(parameters):
    arm = Arm(CONE, AIR, order=2)
    sound = parameters(elasticity__E=2e5, damping__eta=500.0)
    mad = parameters(elasticity__E=2e5, damping__eta=-5e5)
    t = (np.arange(500) + 0.5) / 250
    base = np.stack([0.3 * np.sin(8 * t), 2.4 * np.cos(8 * t), -19.2 * np.sin(8 * t)])[:, :, None]
    alone = simulate(arm, np.repeat(sound[:, None], 5, 1), base, Timing(1 / 250))
    mixed = simulate(arm, np.stack([sound, sound, mad, sound, sound], 1), base, Timing(1 / 250))
    assert np.isfinite(mixed.diverged[2])
    assert np.isnan(mixed.mean_thrust[2])
    for b in (0, 1, 3, 4):
        assert np.isnan(mixed.diverged[b])
        assert np.array_equal(mixed.q[..., b], alone.q[..., b])
        assert mixed.mean_thrust[b] == alone.mean_thrust[b]
