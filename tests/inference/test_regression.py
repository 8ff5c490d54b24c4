"""The paper's regression and the weak form on the model's own motion: exact without noise,
and what noise does to them.
"""

import numpy as np
import pytest

from affine_model.arm import Arm
from affine_model.simulate import Timing, simulate
from inference.linear_fit import fit_linear
from inference.measured_motion import MeasuredCourse, local_polynomials
from inference.regression import regression
from inference.weak_form import Bumps, weak_system
from tentacle.errors import InputError
from tentacle.specimen import WATER, Cone, Gravity, Specimen
from tentacle.waveform import Chirp

ARM = Arm(Specimen(Cone(0.0125, 0.003), 0.14, 1070.0), WATER, Gravity(0.0), order=2)
FREE = (("elasticity", "k0"), ("elasticity", "k1"), ("damping", "d0"), ("damping", "d1"), ("drag", "C_perp"))
TRUTH = np.array([3.5e-2, -2.9e-2, 3e-4, -2e-4, 1.1])  # the paper's pi
WAVE = Chirp(0.6, 0.4, 2.5, 12.0)


def weak_form(arm, parameters, free, course, width):
    """The fit of the weak form's residual, overlapping bumps counted once."""
    bumps = Bumps(width)
    return fit_linear(weak_system(arm, course, bumps), parameters, free, independent=1.0 / bumps.overlap)


def motion(parameters, per_second=120, **more):
    values = {f"{effect}__{name}": value for (effect, name), value in zip(FREE, TRUTH, strict=True)}
    p = parameters(**values, **more)
    steps = 12 * 960
    t = (np.arange(steps) + 0.5) / 960
    batch = simulate(ARM, p[:, None], WAVE(t)[:, :, None], Timing(1 / 960, 960 // per_second))
    return p, batch.t, batch.q[..., 0], WAVE(batch.t)


def start(parameters, **more):
    return parameters(elasticity__k0=2e-2, elasticity__k1=-1e-2, damping__d0=1e-4, drag__C_perp=0.5, **more)


def test_local_polynomials_are_exact_on_quartics_at_uneven_times():
    t = np.cumsum(np.random.default_rng(0).uniform(0.5, 1.5, 40)) / 40
    values = np.stack([t**4 - t, 2 * t**3], axis=1)
    found = local_polynomials(t, values, 9)
    exact = (values, np.stack([4 * t**3 - 1, 6 * t**2], 1), np.stack([12 * t**2, 12 * t], 1))
    for a, b in zip(found, exact, strict=True):
        np.testing.assert_allclose(a, b, atol=1e-8)
    with pytest.raises(InputError, match="window"):
        local_polynomials(t, values, 4)
    with pytest.raises(InputError, match="differentiated"):
        local_polynomials(t[::-1], values, 9)


def test_regression_recovers_the_paper_s_parameters_without_noise(parameters):
    _, t, q, base = motion(parameters, per_second=240)
    found = regression(ARM, start(parameters), FREE, MeasuredCourse(t, q, base), window=7)
    # What is left is the quartics' smoothing of motion at up to 20 Hz (the second mode rings after the start): 2 %.
    np.testing.assert_allclose(found.values, TRUTH, rtol=0.02)
    assert found.condition < 100
    assert found.covariance.shape == (5, 5)


def test_weak_form_recovers_them_too(parameters):
    _, t, q, base = motion(parameters)
    found = weak_form(ARM, start(parameters), FREE, MeasuredCourse(t, q, base), 0.3)
    np.testing.assert_allclose(found.values, TRUTH, rtol=0.02)


@pytest.mark.parametrize(
    ("effect", "name", "value"), [("added_mass", "C_a", 0.8), ("tip_mass", "mass", 1e-3), ("current", "U_x", 0.04)]
)
def test_any_effect_is_a_column_at_once(parameters, effect, name, value):
    _, t, q, base = motion(parameters, 240, **{f"{effect}__{name}": value})
    free = (*FREE, (effect, name))
    course = MeasuredCourse(t, q, base)
    for method, weights in ((regression, ()), (weak_form, (0.3,))):
        given = start(parameters, **({f"{effect}__{name}": value} if effect == "current" else {}))
        found = method(ARM, given, free, course, *weights)
        assert found.values[-1] == pytest.approx(value, rel=0.05)


def test_noise_biases_the_regression_and_more_data_do_not_help(parameters):
    """Errors in variables: with 3 mrad on q the paper's estimate moves away by far more than it scatters."""
    _, t, q, base = motion(parameters)
    sigma = np.array([1.7e-3, 6.0e-3]) * 0.5
    strong, weak = [], []
    for seed in range(5):
        noisy = q + np.random.default_rng(seed).normal(size=q.shape) * sigma
        strong.append(regression(ARM, start(parameters), FREE, MeasuredCourse(t, noisy, base)).values)
        weak.append(weak_form(ARM, start(parameters), FREE, MeasuredCourse(t, noisy, base), 0.3).values)
    bias, scatter = np.mean(strong, 0) / TRUTH - 1, np.std(strong, 0) / np.abs(TRUTH)
    print("regression: bias", bias, "scatter", scatter)
    print("weak form:  bias", np.mean(weak, 0) / TRUTH - 1, "scatter", np.std(weak, 0) / np.abs(TRUTH))
    # The bias stands: it is many times the scatter of one estimate, so averaging would not remove it.
    assert np.max(np.abs(bias) / scatter) > 5
    assert np.max(np.abs(bias)) > 0.3
    # Its stated standard deviations do not cover it; the weak form's error is several times smaller.
    assert np.max(np.abs(np.mean(weak, 0) / TRUTH - 1)) < 0.5 * np.max(np.abs(bias))


def test_a_window_or_width_that_cannot_work_is_refused(parameters):
    _, t, q, base = motion(parameters)
    with pytest.raises(InputError, match="width"):
        weak_form(ARM, start(parameters), FREE, MeasuredCourse(t, q, base), 0.01)
    with pytest.raises(InputError, match="window"):
        regression(ARM, start(parameters), FREE, MeasuredCourse(t, q, base), window=3)
