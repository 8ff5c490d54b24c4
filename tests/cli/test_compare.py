import numpy as np
import pytest

from tentacle.cli import _validity
from tentacle.cli._ladder import affine_frequencies, climb, theory_frequencies
from tentacle.cli._twins import affine_twin, net_weight, reference_twin, shape_error
from tentacle.cli._validity import AMPLITUDES, ORDERS, RATIOS, Validity, cell, own_taper, tapered
from tentacle.model import Estimate, Model
from tentacle.model_file import model_tables
from tentacle.specimen import WATER, Cone, Specimen
from tentacle.waveform import Ramped, Sine


def swimmer() -> Model:
    model = Model(Specimen(Cone(0.0125, 0.00125), 0.14, 1070.0), WATER)
    model = model.with_effect("elasticity", E=Estimate.exact(2e5)).with_effect("damping", eta=Estimate.exact(300.0))
    return model.with_effect("drag", C_perp=Estimate.exact(1.1)).with_effect("added_mass", C_a=Estimate.exact(1.0))


def test_two_implementations_agree_where_they_should():
    # Neither shares an equation with the other. Six coordinates follow the arm to 10 micrometres of 70 mm.
    wave = Ramped(Sine(0.5, 1.3), 0.8)
    reference = reference_twin(swimmer(), wave, 3.0, 50.0, links=40)
    affine = affine_twin(swimmer(), 6, wave, 3.0, 50.0)
    assert shape_error(affine, reference, 2.0)[0] < 0.02
    window = 2 / 1.3
    # Both at 2 to 3 ms a step; the reduced model's load cell agrees to 1 % of the mean.
    assert affine.mean_load(window) == pytest.approx(reference.mean_load(window), abs=1e-4)


def test_an_arm_at_rest_weighs_what_it_should():
    still = reference_twin(swimmer(), Sine(0.0, 1.0), 0.5, 50.0)
    assert np.abs(still.load).max() < 1e-9
    arm = affine_twin(swimmer(), 2, Sine(0.0, 1.0), 0.5, 50.0)
    assert np.abs(arm.load).max() < 1e-6 + 1e-6 * net_weight(swimmer())


def test_the_ladder_climbs():
    ladder = climb(swimmer(), 0.4)
    first = ladder.rungs[0]
    theory = theory_frequencies(swimmer())
    assert theory is not None
    assert first.theory == pytest.approx(theory[0])
    assert first.best == pytest.approx(theory[0], rel=5e-3)  # rotary inertia
    for rung in ladder.rungs:
        assert rung.error(4) <= rung.error(2) + 1e-3, rung.name
    assert ladder.rungs[1].error(2) > 0.08  # the second mode, which two coordinates cannot follow (physics.md)


def test_affine_frequencies_are_those_of_the_rayleigh_ritz_targets():
    # physics.md: taper .1, order 2: 7.2113 and 21.28 times sqrt(E I0 / rho A0 L^4).
    from dataclasses import replace

    from tentacle.specimen import AIR, Gravity

    thin = Specimen(Cone(0.00125, 0.000125), 0.14, 1070.0)
    model = replace(swimmer(), specimen=thin, fluid=AIR, gravity=Gravity(0.0, 0.0))
    rate = np.sqrt(2e5 * np.pi / 4 * 0.00125**4 / (1070 * np.pi * 0.00125**2 * 0.14**4)) / (2 * np.pi)
    np.testing.assert_allclose(affine_frequencies(model, 2) / rate, [7.2113, 21.28], rtol=1e-3)


def test_a_cell_of_the_map():
    found = cell({"model": model_tables(swimmer()), "links": 20, "amplitude": 0.4, "frequency": 1.7})
    assert found["shape"][2] < found["shape"][0] < 0.02
    assert found["thrust_n"] < 0.0


def test_reach_ends_where_the_error_passes_the_level():
    shape = np.full((len(ORDERS), len(AMPLITUDES), len(RATIOS)), 0.001)
    shape[0, 0, 3:] = 0.2
    shape[0, 1, :] = 0.2
    found = Validity(0.1, 3.0, shape, shape, shape[0], np.zeros(3))
    assert found.reach(2, 0.01, 0) == RATIOS[2]
    assert found.reach(2, 0.01, 1) == 0.0
    assert found.reach(3, 0.01, 0) == RATIOS[-1]


def test_tapers_change_the_tip_alone():
    model = tapered(swimmer(), 0.5)
    assert own_taper(model) == pytest.approx(0.5)
    assert model.specimen.length == swimmer().specimen.length
    assert _validity.flexibility(model, 3.0)[0, 0] > 0.0
