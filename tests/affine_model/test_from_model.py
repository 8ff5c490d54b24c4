"""Simulations that start from a model: the same motion as from its parts, and refusals that say where."""

import numpy as np
import pytest

from affine_model.arm import arm_of, parameter_vector
from affine_model.from_model import simulate_model
from affine_model.simulate import Timing, simulate
from tentacle.errors import InputError
from tentacle.model import Estimate, Model
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Sine

MODEL = (
    Model(Specimen(Cone(0.0125, 0.003), 0.14, 1070.0), WATER)
    .with_effect("elasticity", E=Estimate.exact(2e5, "Pa"))
    .with_effect("drag", C_perp=Estimate.exact(1.1))
)


def test_a_model_moves_as_its_parts_do():
    wave = Sine(0.5, 1.3)
    times = (np.arange(100) + 0.5) / 500
    parts = simulate(arm_of(MODEL), parameter_vector(MODEL)[:, None], wave(times)[:, :, None], Timing(1 / 500))
    # Times are summed in another order: rounding.
    np.testing.assert_allclose(simulate_model(MODEL, wave, 0.2).q, parts.q, atol=1e-13)


def test_a_lagging_servo_moves_the_base_later():
    lagging = MODEL.with_effect("servo_lag", tau=Estimate.exact(0.02, "s"))
    ahead, behind = (simulate_model(model, Sine(0.5, 1.3), 1.0).theta[:, 0] for model in (MODEL, lagging))
    # A first-order lag of 0.02 s delays a slow sine by 0.02 s, ten steps; to (omega tau)^2 / 2 = 1.3 % of the
    # amplitude.
    np.testing.assert_allclose(behind[110:], ahead[100:-10], atol=0.02 * 0.5)


def test_a_stiffness_that_vanishes_is_refused_with_its_place():
    stiffness = {"k0": Estimate.exact(0.01), "k1": Estimate.exact(-0.02)}
    affine = Model(MODEL.specimen, WATER).with_effect("elasticity", **stiffness)
    with pytest.raises(InputError, match=r"s = 0\.500"):
        simulate_model(affine, Sine(0.5, 1.3), 0.1)
    with pytest.raises(InputError, match=r"s = 0\.000"):
        simulate_model(Model(MODEL.specimen), Sine(0.5, 1.3), 0.1)


def test_a_parameter_that_no_effect_has_is_refused():
    with pytest.raises(InputError, match=r"drag\.C_parallel"):
        simulate_model(MODEL.with_effect("drag", C_parallel=Estimate.exact(1.0)), Sine(0.5, 1.3), 0.1)
