"""A model file of every effect of the catalogue through what takes one: simulate, compare, optimise's check."""

from dataclasses import replace

import numpy as np
import pytest

from affine_model.effects import catalogue
from tentacle.gait import Gait
from tentacle.io.model_file import read_model, write_model
from tentacle.model import Estimate, Model
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Ramped, Sine
from validation import reference_swim
from validation.model_pair import affine_twin, reference_twin, shape_error

BASE = {"elasticity": {"E": 2e5}, "damping": {"eta": 1.5e3}, "drag": {"C_perp": 1.1}}
WAVE = Ramped(Sine(0.35, 1.2), 0.3)
GAIT = Gait((0.4, 0.0, 0.0, 8.0, 8.0, 8.0, 0.0, 0.0, 0.0))


def model_with(name: str) -> Model:
    nominal = {} if name in BASE else {name: {p.name: p.nominal for p in catalogue()[name].parameters}}
    tables = {effect: {p: Estimate.exact(v) for p, v in own.items()} for effect, own in (BASE | nominal).items()}
    return replace(Model(Specimen(Cone(0.0125, 0.004), 0.14, 1070.0), WATER, order=4), parameters=tables)


@pytest.mark.parametrize("name", sorted(catalogue()))
def test_a_model_file_of_it_serves_simulate_compare_and_optimise(name, tmp_path, monkeypatch):
    write_model(model_with(name), tmp_path / "model.toml")
    model = read_model(tmp_path / "model.toml")
    assert model.parameters == model_with(name).parameters
    reduced, reference = (affine_twin(model, 4, WAVE, 0.6, 50.0), reference_twin(model, WAVE, 0.6, 50.0, links=30))
    # The tip sweeps 40 to 60 mm. Order 4 and 30 links leave under .02 mm of most effects, .2 of a soft spot .08 wide.
    assert shape_error(reduced, reference, 0.6)[0] < 0.25
    for name, seconds in (("LEAD_IN_S", 0.2), ("SETTLE_S", 0.2), ("WINDOW_S", 0.4)):
        monkeypatch.setattr(reference_swim, name, seconds)
    assert np.isfinite(reference_swim.reference_thrust(model, GAIT))
    assert np.isfinite(reference_swim.reference_speed(model, GAIT))
