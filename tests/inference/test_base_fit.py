"""The declared model's fit: its parameters, and the number of curvature coordinates that the shapes show."""

from dataclasses import replace

import numpy as np
import pytest

from affine_model.arm import parameter_index
from inference.base_fit import Setting, fit_baseline_alone, needed_order, rough_base_fit
from inference.prepare import prepare
from tentacle.recording import Declaration
from tentacle.specimen import WATER
from tests.made_recordings import SPECIMEN, Run, as_markers, record_declared


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


def test_what_the_baseline_says_does_not_depend_on_where_its_fit_begins():
    """A fit to all recordings begins it, and leans to what acts in the others. With a memory its valley is curved."""
    declaration = Declaration(replace(SPECIMEN, laws=("viscoelasticity",)), WATER)
    memory = {("viscoelasticity", "g"): 0.6, ("viscoelasticity", "tau"): 0.4}
    experiments = [
        replace(
            prepare(record_declared(declaration, memory | hidden, Run(seed=seed)), hold_out=False).experiment,
            complete=not hidden,
        )
        for seed, hidden in enumerate([{("current", "U_x"): 0.05}, {}])
    ]
    setting = Setting(declaration, tuple(experiments), 2)
    warm = rough_base_fit(setting, 2)[1]
    ends = []
    for stiffer, larger in ((1.0, 1.0), (0.6, 4.0)):
        begun = warm.parameters.copy()
        begun[parameter_index("elasticity", "E")] *= stiffer
        begun[parameter_index("viscoelasticity", "g")] *= larger
        ends.append(fit_baseline_alone(setting, 2, warm=replace(warm, parameters=begun))[1].values)
    # Two ends of one valley differ by less than a tenth of what the recording leaves open, 1 % of g and tau.
    np.testing.assert_allclose(ends[0], ends[1], rtol=1e-3)
