"""The compiled kernel against the readable assembly, effect by effect: same laws, so the same motion."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from affine_model.arm import Arm, active_effects, neutral_parameters, parameter_index, parameter_rows
from affine_model.dynamics import Instant, advanced_memory, balance, parameters_of, remembering
from affine_model.effects import catalogue
from affine_model.simulate import Start, Timing, simulate
from tentacle.specimen import WATER, Cone, Gravity, Specimen
from tentacle.waveform import Sine

ARM = Arm(Specimen(Cone(0.0125, 0.003), 0.14, 1070.0, tip_mass=0.001), WATER, Gravity(0.2), order=3, nodes=8)
WAVE = Sine(0.5, 1.3, 0.4)
DURATION = 0.4


def base_parameters():
    p = neutral_parameters()
    for effect, name, value in (("elasticity", "E", 2e5), ("damping", "eta", 2e3), ("drag", "C_perp", 1.1)):
        p[parameter_index(effect, name)] = value
    return p


def kernel_state(parameters, step, q0):
    steps = round(DURATION / step)
    middles = (np.arange(steps) + 0.5) * step
    batch = simulate(
        ARM, parameters[:, None], WAVE(middles)[:, :, None], Timing(step, iterations=3), start=Start(q=q0[:, None])
    )
    return np.concatenate([batch.q[-1, :, 0], batch.q_rate[-1, :, 0]])


def accelerations(parameters, t, z, z_rate, memory):
    theta, theta_rate, theta_acceleration = WAVE(t)
    n = ARM.order
    u, v = np.concatenate([z, [theta, 0.0]]), np.concatenate([z_rate, [theta_rate, 0.0]])
    b = balance(ARM, active_effects(parameters), parameters, u, v, Instant(t, memory))
    given = np.array([theta_acceleration, 0.0])
    return np.linalg.solve(b.mass_matrix[:n, :n], b.force[:n] - b.mass_matrix[:n, n:] @ given)


def reference_state(parameters, q0, memory0=0.0):
    n, nodes = ARM.order, ARM.nodes
    relaxing = remembering(active_effects(parameters))
    times = [effect.relaxation_time for effect in relaxing if effect.relaxation_time is not None]
    tau = times[0](SimpleNamespace(**ARM.arm_quantities), parameters_of(relaxing[0], parameters)) if times else np.inf

    def rate(t, state):
        z, z_rate, memory = state[:n], state[n : 2 * n], state[2 * n :]
        relaxation = ARM.curvature_basis @ z_rate - memory / tau if relaxing else np.zeros(nodes)
        return np.concatenate([z_rate, accelerations(parameters, t, z, z_rate, memory[None]), relaxation])

    start = np.concatenate([ARM.from_monomial @ q0, np.zeros(n), np.full(nodes, memory0)])
    solution = solve_ivp(rate, (0.0, DURATION), start, method="DOP853", rtol=1e-9, atol=1e-11)
    end = solution.y[:, -1]
    return np.concatenate([ARM.to_monomial @ end[:n], ARM.to_monomial @ end[n : 2 * n]])


def stepped_state(parameters, step, q0):
    """The readable assembly by explicit midpoint steps: for a memory that yields, which has kinks in time."""
    effects = active_effects(parameters)
    z, z_rate = ARM.from_monomial @ q0, np.zeros(ARM.order)
    memory = np.zeros((len(remembering(effects)), ARM.nodes))
    for k in range(round(DURATION / step)):
        t = k * step
        half = advanced_memory(ARM, effects, parameters, memory, ARM.curvature_basis @ z_rate, 0.5 * step)
        early = z_rate + 0.5 * step * accelerations(parameters, t, z, z_rate, memory)
        acceleration = accelerations(parameters, t + 0.5 * step, z + 0.5 * step * z_rate, early, half)
        memory = advanced_memory(ARM, effects, parameters, memory, ARM.curvature_basis @ early, step)
        z, z_rate = z + step * early, z_rate + step * acceleration
    return np.concatenate([ARM.to_monomial @ z, ARM.to_monomial @ z_rate])


IN_DYNAMICS = [
    e.name
    for e in catalogue().values()
    if e.base is None and e.sight is None and not e.extra_order and e.yield_curvature is None
]


@pytest.mark.parametrize("name", IN_DYNAMICS)
def test_kernel_equals_assembly(name):
    p = base_parameters()
    for row in parameter_rows():
        if row.effect == name and catalogue()[name].family != "base":
            p[row.index] = row.parameter.nominal
    q0 = np.array([0.4, -0.6, 0.3])
    truth = reference_state(p, q0)
    # Second order in the step: Richardson from two steps leaves fourth order, far under the tolerance.
    coarse, fine = kernel_state(p, 1 / 2000, q0), kernel_state(p, 1 / 4000, q0)
    extrapolated = (4 * fine - coarse) / 3
    scale = np.array([1, 1, 1, 20, 20, 20.0])
    assert np.max(np.abs(extrapolated - truth) / scale) < 2e-6
    # Second order: halving the step quarters the error, unless rounding is all there is.
    errors = [np.max(np.abs(state - truth) / scale) for state in (coarse, fine)]
    assert errors[1] < 0.3 * errors[0] + 1e-8


def test_kernel_equals_assembly_where_a_memory_yields():
    p = base_parameters()
    p[parameter_index("dry_friction", "c_f")], p[parameter_index("dry_friction", "slip")] = 0.1, 0.02
    q0 = np.array([0.4, -0.6, 0.3])
    scale = np.array([1, 1, 1, 20, 20, 20.0])
    truth, free = stepped_state(p, 1 / 8000, q0), kernel_state(base_parameters(), 1 / 8000, q0)
    assert (
        np.max(np.abs(kernel_state(p, 1 / 8000, q0) - truth) / scale) < 2e-4
    )  # kinks cost the order: first, not second
    assert np.max(np.abs(free - truth) / scale) > 1e-2  # and the friction does matter


def test_a_maxwell_branch_begins_with_what_it_is_given():
    p = base_parameters()
    p[parameter_index("viscoelasticity", "g")], p[parameter_index("viscoelasticity", "tau")] = 0.5, 0.4
    q0, remembered = np.array([0.4, -0.6, 0.3]), np.array([[0.2], [0.0], [0.0]])  # a constant curvature
    states = []
    for step in (1 / 2000, 1 / 4000):
        middles = (np.arange(round(DURATION / step)) + 0.5) * step
        batch = simulate(
            ARM,
            p[:, None],
            WAVE(middles)[:, :, None],
            Timing(step, iterations=3),
            start=Start(q=q0[:, None], memory=remembered),
        )
        states.append(np.concatenate([batch.q[-1, :, 0], batch.q_rate[-1, :, 0]]))
    truth = reference_state(p, q0, 0.2)
    assert np.max(np.abs((4 * states[1] - states[0]) / 3 - truth) / np.array([1, 1, 1, 20, 20, 20.0])) < 2e-6


@pytest.mark.parametrize(
    "shape", [{"sliding": 1.0, "rate": 0.1}, {"sliding": 0.0, "slip": 0.001}], ids=["tanh", "slip"]
)
def test_stiff_friction_does_not_ring(shape):
    """At the tip, friction damps faster than a step: with the tangents of such a law the motion rings, and errs by 7 %
    at these steps. A rule of second order errs by (h w)^2 / 12 of its own part in the motion, here 1e-3.
    """
    arm = Arm(Specimen(Cone(0.01, 0.0025), 0.15, 1070.0), WATER, Gravity(0.0), order=6)
    parameters = base_parameters()
    for name, value in {"c_f": 0.02, **shape}.items():
        parameters[parameter_index("dry_friction", name)] = value

    def tip_angle(step):
        middles = (np.arange(round(1.0 / step)) + 0.5) * step
        timing = Timing(step, stride=round(1.0 / 60.0 / step))
        q = simulate(arm, parameters[:, None], Sine(0.2, 2.0)(middles)[:, :, None], timing).q[:, :, 0]
        return q @ (1.0 / np.arange(1.0, 7.0))

    exact = tip_angle(1.0 / 9600.0)
    error = [np.linalg.norm(tip_angle(step) - exact) / np.linalg.norm(exact) for step in (1.0 / 300.0, 1.0 / 1200.0)]
    assert error[0] < 4e-3
    assert error[1] < 0.2 * error[0]  # second order would be a sixteenth, if the law had no kink


def test_a_neighbour_with_friction_changes_no_other_individual():
    """A law that levels off takes more corrections a step; the other lanes of its block wait, to the last bit."""
    plain = base_parameters()
    rough = plain.copy()
    rough[parameter_index("dry_friction", "c_f")] = 0.05
    middles = (np.arange(240) + 0.5) / 600.0
    alone, beside = (
        simulate(ARM, np.stack(columns, axis=1), WAVE(middles)[:, :, None], Timing(1.0 / 600.0))
        for columns in ([plain, plain], [plain, rough])
    )
    np.testing.assert_array_equal(alone.q[:, :, 0], beside.q[:, :, 0])
    np.testing.assert_array_equal(alone.torque[:, 0], beside.torque[:, 0])
    assert np.abs(alone.q[:, :, 1] - beside.q[:, :, 1]).max() > 1e-3
