import numpy as np
import pytest

from mujoco_ref.crosscheck import reduction_error
from mujoco_ref.simulate import simulate
from tentacle.errors import InputError
from tentacle.waveform import Sine
from tests.mujoco_ref.arms import swimming_model

S = np.linspace(0.0, 1.0, 11)


def test_the_reference_against_itself_loses_nothing():
    model, wave = swimming_model(), Sine(0.4, 1.0)
    run = simulate(model, wave, 1.0, 60.0, s=S)
    found = reduction_error(model, wave, run.t, S, run.midline.xy)
    assert found.rms_mm < 2e-3  # the spline between frames, and another step


def test_a_known_displacement_is_measured():
    model, wave = swimming_model(), Sine(0.4, 1.0)
    run = simulate(model, wave, 0.5, 60.0, s=S)
    found = reduction_error(model, wave, run.t, S, run.midline.xy + np.array([3e-3, 4e-3]))
    assert found.rms_mm == pytest.approx(5.0, abs=3e-3)
    np.testing.assert_allclose(found.per_point_mm, 5.0, atol=0.01)


def test_it_starts_where_the_reduced_model_does():
    model, wave = swimming_model(), Sine(0.0, 1.0)
    q, rate = np.array([0.4, -0.2]), np.array([1.0, 0.5])
    run = simulate(model, wave, 0.3, 60.0, s=S, initial_q=q, initial_q_rate=rate)
    late = run.t + 5.0  # a recording's clock need not start at 0
    found = reduction_error(model, wave, late, S, run.midline.xy, initial_q=q, initial_q_rate=rate)
    assert found.rms_mm < 2e-2  # the first 5 ms ring fast: the spline between frames


def test_shapes_that_do_not_fit_are_refused():
    with pytest.raises(InputError, match="shape"):
        reduction_error(swimming_model(), Sine(0.4, 1.0), np.array([0.0, 1.0]), S, np.zeros((3, 11, 2)))
    with pytest.raises(InputError, match="rise"):
        reduction_error(swimming_model(), Sine(0.4, 1.0), np.array([1.0, 0.0]), S, np.zeros((2, 11, 2)))
