"""The declared model's fit: its parameters, and the number of curvature coordinates that the shapes show."""

import numpy as np
import pytest

from affine_model.arm import parameter_index
from inference.base_fit import Setting, needed_order
from inference.prepare import prepare
from tests.made_recordings import as_markers


def test_base_parameters_are_recovered_within_their_intervals(plain):
    truth = np.array([2e5, 1.5e3, 1.1])
    spread = np.sqrt(np.diag(plain.fitted.covariance))
    # Four standard deviations of each; and the fit is sharp: 0.1 mm of noise leaves E to better than 1 %.
    assert np.all(np.abs(plain.fitted.values - truth) < 4.0 * spread)
    assert spread[0] < 0.01 * truth[0]
    assert plain.fitted.parameters[parameter_index("elasticity", "E")] == plain.fitted.values[0]


@pytest.mark.parametrize("order", [2, 3])
def test_the_order_is_seen_in_the_shapes(recorded, order):
    # The third coordinate's motion here is some tenths of a millimetre, ten times the noise of 0.02 mm.
    recording = recorded(order=order, noise=2e-5, seconds=6.0)
    setting = Setting(recording.declaration, (prepare(recording, hold_out=True).experiment,), 2)
    assert needed_order(setting) == order


@pytest.mark.parametrize("hidden", [{}, {("intrinsic_curvature", "c0"): 0.05}])
def test_the_order_of_markers_is_what_the_model_needs_at_that_noise_whatever_is_hidden(recorded, hidden):
    def needed(noise):
        recording = as_markers(recorded(hidden, order=4, noise=noise, seconds=6.0))
        return needed_order(Setting(recording.declaration, (prepare(recording, hold_out=True).experiment,), 2))

    assert needed(3e-3) == 2
    assert needed(2e-5) > 2
