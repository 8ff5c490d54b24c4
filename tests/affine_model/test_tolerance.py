"""The step control keeps what it promises, for each individual by itself."""

import numpy as np
import pytest

from affine_model.arm import Arm, parameter_index
from affine_model.simulate import Timing, simulate
from affine_model.tolerance import Goal, simulate_to_tolerance
from tentacle.specimen import WATER, Cone, Gravity, Specimen
from tentacle.waveform import Sine

ARM = Arm(Specimen(Cone(0.0125, 0.001), 0.14, 1070.0), WATER, Gravity(0.0), order=2)
WAVE = Sine(0.6, 1.5)


def batch_parameters(parameters):
    p = np.repeat(parameters(damping__eta=800.0, drag__C_perp=1.1)[:, None], 3, axis=1)
    p[parameter_index("elasticity", "E")] = [5e4, 2e5, 2e6]  # the stiffer, the faster its ringing
    return p


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5])
def test_the_error_stays_below_the_tolerance(parameters, tolerance):
    p = batch_parameters(parameters)
    found = simulate_to_tolerance(ARM, p, WAVE, Goal(2.0, tolerance))
    h = 1 / 32000
    truth = simulate(ARM, p, WAVE((np.arange(64000) + 0.5) * h)[:, :, None], Timing(h, 640))
    z = np.einsum("jk,tkb->tjb", ARM.from_monomial, found.batch.q - truth.q)
    error = np.abs(np.einsum("ij,tjb->tib", ARM.angle_basis, z)).max(axis=(0, 1))
    assert np.all(found.error <= tolerance)
    assert np.all(error <= 1.3 * tolerance)  # an estimate, to leading order in the step
    np.testing.assert_allclose(found.batch.t, truth.t, atol=1e-12)
    # Its estimate is no idle bound either.
    assert np.all(found.error > 0.3 * error)


def test_only_who_needs_it_gets_a_finer_step(parameters):
    found = simulate_to_tolerance(ARM, batch_parameters(parameters), WAVE, Goal(2.0, 1e-4))
    assert found.step[2] < found.step[0]


def test_a_tolerance_beyond_reach_is_said_so(parameters):
    with pytest.raises(ArithmeticError, match="remains at a step"):
        simulate_to_tolerance(ARM, batch_parameters(parameters)[:, :1], WAVE, Goal(0.1, 1e-15))


def test_a_diverging_individual_does_not_hold_up_the_others(parameters):
    p = batch_parameters(parameters)
    p[parameter_index("damping", "eta"), 1] = -5e5
    found = simulate_to_tolerance(ARM, p, WAVE, Goal(1.0, 1e-3))
    assert np.isnan(found.error[1])
    assert np.isfinite(found.batch.diverged[1])
    assert np.all(found.error[[0, 2]] <= 1e-3)
