"""The plant of the promises: its thrust under a gait is that of the model with the plant's own parameters."""

import numpy as np
import pytest

from affine_model.swim import run, trial_of
from tentacle.gait import Gait
from tentacle.model import Estimate, Model
from validation.plants import drawn
from validation.plants.draw import USUAL_FILMING
from validation.plants.filmed import declaration_of
from validation.swim_promise import Promised, delivered_thrust, whole_periods


@pytest.mark.parametrize(("seed", "carries"), [(1, True), (5, False)])
def test_the_plant_pulls_as_the_model_of_its_own_parameters(seed, carries):
    trial = drawn(seed, (), {}, USUAL_FILMING, (6.0, 15.0))
    assert trial.carries == carries  # added mass, declared
    declared = declaration_of(trial)
    model = Model(declared.specimen, declared.fluid, declared.gravity, 6)
    model = model.with_effect("elasticity", E=Estimate.exact(trial.arm["E"], "Pa"))
    model = model.with_effect("damping", eta=Estimate.exact(trial.arm["eta"], "Pa s"))
    model = model.with_effect("drag", C_perp=Estimate.exact(trial.arm["C_perp"]))
    omega = 2.0 * np.pi * 1.2
    gait = Gait((0.5, 0.0, 0.0, omega, omega, omega, 0.0, 0.0, 0.0), 5.0)
    promised = run(whole_periods(trial_of(model), gait), np.array([gait.alpha]).T).thrust[0, 0]
    # The plant's rule is of first order, with steps of a quarter to half a millisecond, and its links are few: 1 %.
    assert delivered_thrust(trial, gait) == pytest.approx(promised, rel=0.015)


def test_a_promise_is_kept_within_its_interval():
    one = Promised(1, "at the estimates", 0.04, (0.039, 0.041), (0.0395, 0.0405), 0.0408)
    assert one.kept
    assert one.ratio == pytest.approx(1.02)
