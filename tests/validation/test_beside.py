"""R of one of two hidden effects beside the other."""

import numpy as np
import pytest

from affine_model.effects import catalogue
from validation.trials.beside import sizes_beside, starts_of
from validation.trials.plant_design import PlantDesign
from validation.trials.plant_recording import plant_recording


def _design(*effects: str) -> PlantDesign:
    return PlantDesign(0, 11, "pair", effects, "stranger", "midline", 12.0, 1e-4)


def test_a_clock_s_error_takes_the_place_of_a_small_lag_and_a_wrong_scale_hides_nothing():
    # A lag much shorter than the motion's periods delays it, which a clock's offset does too; a scale stretches it.
    together, apart = _design("servo_lag", "time_offset"), _design("servo_lag", "camera_scale")
    by_itself = plant_recording(together)[1]["r"][0]
    assert sizes_beside(together)[0] < 0.05 * by_itself
    assert sizes_beside(apart)[0] == pytest.approx(by_itself, rel=0.05)


def test_one_effect_has_nothing_beside_it():
    assert sizes_beside(_design("time_offset")) == []


@pytest.mark.parametrize("name", ["current", "sloshing", "soft_spot", "backlash"])
def test_starts_are_within_bounds_and_differ(name: str):
    law = catalogue()[name]
    starts = np.array(starts_of(law))
    low, high = np.array([one.bounds for one in law.parameters]).T
    assert np.all((low <= starts) & (starts <= high))
    assert len(np.unique(starts, axis=0)) == len(starts) > len(law.parameters)
