"""The compiled kernel against the readable assembly, effect by effect: same laws, so the same motion."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from affine_model.arm import Arm, active_effects, neutral_parameters, parameter_index, parameter_rows
from affine_model.dynamics import balance
from affine_model.effects import catalogue
from affine_model.simulate import simulate
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
    batch = simulate(ARM, parameters[:, None], WAVE(middles)[:, :, None], step, q=q0[:, None], iterations=3)
    return np.concatenate([batch.q[-1, :, 0], batch.q_rate[-1, :, 0]])


def reference_state(parameters, q0):
    effects = active_effects(parameters)
    n, nodes = ARM.order, ARM.nodes
    relaxing = next((e for e in effects if e.relaxation_time is not None), None)
    tau = parameters[parameter_index("viscoelasticity", "tau")]

    def rate(t, state):
        theta, theta_rate, theta_acceleration = WAVE(t)
        z, z_rate, memory = state[:n], state[n : 2 * n], state[2 * n :]
        u, v = np.concatenate([z, [theta, 0.0]]), np.concatenate([z_rate, [theta_rate, 0.0]])
        b = balance(ARM, effects, parameters, u, v, t, memory)
        given = np.array([theta_acceleration, 0.0])
        z_acc = np.linalg.solve(b.mass_matrix[:n, :n], b.force[:n] - b.mass_matrix[:n, n:] @ given)
        relaxation = ARM.curvature_basis @ z_rate - memory / tau if relaxing else np.zeros(nodes)
        return np.concatenate([z_rate, z_acc, relaxation])

    start = np.concatenate([ARM.from_monomial @ q0, np.zeros(n + nodes)])
    solution = solve_ivp(rate, (0.0, DURATION), start, method="DOP853", rtol=1e-9, atol=1e-11)
    end = solution.y[:, -1]
    return np.concatenate([ARM.to_monomial @ end[:n], ARM.to_monomial @ end[n : 2 * n]])


IN_DYNAMICS = [e.name for e in catalogue().values() if e.base is None and e.measurement is None and not e.extra_order]


@pytest.mark.parametrize("name", IN_DYNAMICS)
def test_kernel_equals_assembly(name):
    p = base_parameters()
    for row in parameter_rows():
        if row.effect == name and catalogue()[name].family != "base":
            p[row.index] = row.parameter.nominal
    q0 = np.array([0.4, -0.6, 0.3])
    truth = reference_state(p, q0)
    # Second order in the step: Richardson from two steps leaves fourth order, far under the tolerance. Dry friction is
    # stiff.
    coarse, fine = kernel_state(p, 1 / 2000, q0), kernel_state(p, 1 / 4000, q0)
    extrapolated = (4 * fine - coarse) / 3
    scale = np.array([1, 1, 1, 20, 20, 20.0])
    assert np.max(np.abs(extrapolated - truth) / scale) < 2e-6
    # Second order: halving the step quarters the error, unless rounding is all there is.
    errors = [np.max(np.abs(state - truth) / scale) for state in (coarse, fine)]
    assert errors[1] < 0.3 * errors[0] + 1e-8
