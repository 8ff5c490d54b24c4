"""Declared numbers with a spread: data that know them find them; data that do not leave them as declared."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from inference.base_fit import Setting, fit_base
from inference.declared_words import declared_words
from inference.estimates import declared_deviations
from inference.fit import Fit
from inference.identify import identify
from inference.prepare import prepare
from inference.trajectory import Problem
from tentacle.declared import Uncertain, with_values
from tentacle.recording import Recording
from tentacle.specimen import AIR
from tests.made_recordings import SPECIMEN, as_markers

LENGTH, DENSITY = "specimen.length_m", "specimen.density_kg_m3"


def declared_as(recording: Recording, *numbers: Uncertain) -> Recording:
    means = {number.field: number.value for number in numbers}
    return replace(recording, declaration=replace(with_values(recording.declaration, means), uncertain=numbers))


def fitted_to(recording: Recording) -> tuple[Problem, Fit]:
    setting = Setting(recording.declaration, (prepare(recording, hold_out=False).experiment,), 2)
    return fit_base(setting, 2)


def test_length_and_density_that_the_motion_shows_are_found(recorded) -> None:
    wrong = (Uncertain(LENGTH, 0.136, 0.005, 1e-6), Uncertain(DENSITY, 1000.0, 100.0, 10.0))
    problem, fitted = fitted_to(declared_as(recorded(seconds=6.0), *wrong))
    for field, true in ((LENGTH, SPECIMEN.length), (DENSITY, SPECIMEN.density)):
        place = fitted.free.index(("declared", field))
        deviation = np.sqrt(fitted.covariance[place, place])
        assert abs(fitted.values[place] - true) < 4.0 * deviation  # one draw in 16 000 is farther
        assert deviation < 0.02 * true  # of 100 kg/m3 and 5 mm declared: the data decide
    assert 2.0 * fitted.misfit / fitted.count < 1.1  # a model that is right leaves the noise
    assert any(LENGTH in sentence and "the data say" in sentence for sentence in declared_words(problem, fitted))


def test_a_number_that_the_motion_does_not_show_keeps_its_declared_spread(recorded) -> None:
    """In air stiffness, damping and density appear as ratios only: gravity aside, no motion tells the density."""
    number = Uncertain(DENSITY, SPECIMEN.density, 50.0, 10.0)
    recording = declared_as(recorded(seconds=6.0), number)
    floating = replace(recording.declaration.gravity, magnitude=0.0)
    declaration = replace(recording.declaration, gravity=floating, fluid=AIR)
    problem, fitted = fitted_to(replace(recording, declaration=declaration))
    place = fitted.free.index(("declared", DENSITY))
    assert np.isclose(np.sqrt(fitted.covariance[place, place]), 50.0, rtol=0.02)  # the prior alone, to rounding
    assert declared_words(problem, fitted)[0].endswith("say nothing about it.")


def test_where_the_likelihood_is_coarsened_the_declaration_keeps_its_weight(recorded) -> None:
    """Of one number 1 / var -> (1 / var - 1 / sd^2) / T + 1 / sd^2: with a large T its declared spread is left."""
    number = Uncertain(LENGTH, 0.136, 0.005, 1e-6)
    problem, fitted = fitted_to(declared_as(recorded(seconds=6.0), number))
    plain = declared_deviations(problem, fitted)[LENGTH]
    place = fitted.free.index(("declared", LENGTH))
    assert np.isclose(plain, np.sqrt(fitted.covariance[place, place]), rtol=1e-9)  # the algebra's rounding
    told = (1.0 / plain**2 - 1.0 / 0.005**2) / 18.0 + 1.0 / 0.005**2
    assert np.isclose(declared_deviations(problem, fitted, 18.0)[LENGTH], told**-0.5, rtol=1e-6)
    assert np.isclose(declared_deviations(problem, fitted, 1e12)[LENGTH], 0.005, rtol=1e-3)  # T = 1e12 leaves 1e-5
    assert declared_words(problem, fitted, 1e12)[0].endswith("say nothing about it.")


def test_a_range_that_excludes_the_truth_is_named(recorded) -> None:
    problem, fitted = fitted_to(declared_as(recorded(seconds=6.0), Uncertain(LENGTH, 0.1325, None, 0.130, 0.135)))
    assert fitted.values[fitted.free.index(("declared", LENGTH))] == 0.135  # the nearer end
    assert "check the declaration" in declared_words(problem, fitted)[0]


def test_the_identified_model_is_the_arm_that_was_found(recorded) -> None:
    found = identify([declared_as(recorded(seconds=6.0), Uncertain(LENGTH, 0.136, 0.005, 1e-6))], order=2)
    assert abs(found.model.specimen.length - SPECIMEN.length) < 1e-4  # its deviation is some micrometres
    assert set(found.model.parameters) == {"elasticity", "damping", "drag"}
    # Its posterior is that of the effects' parameters: the length is marginalised, and widens them.
    known = found.model.posterior
    assert known is not None
    assert known.names == ("elasticity.E", "damping.eta", "drag.C_perp")
    places = [found.free.index(name) for name in known.names]
    np.testing.assert_allclose(known.correlation, found.correlation[np.ix_(places, places)], atol=1e-6)
    for name, deviation in zip(known.names, known.deviation, strict=True):
        e = found.model.parameters[name.split(".")[0]][name.split(".")[1]]
        assert abs((e.high - e.low) / 3.92 / deviation - 1.0) < 1e-6


def test_the_error_of_markers_is_stated_at_the_places_that_the_fit_finds(recorded) -> None:
    seen = as_markers(recorded(seconds=6.0))
    markers = seen.markers
    assert markers is not None
    wrong = replace(seen, markers=replace(markers, s=markers.s + np.array([0.0, 0.02, 0.0])))
    number = Uncertain("markers.m1.s", float(markers.s[1]) + 0.02, 0.02, 0.0, 1.0)
    stated = replace(wrong, declaration=replace(wrong.declaration, uncertain=(number,)))
    found = identify([stated], order=2)
    assert found.errors.midline_mm is not None
    assert found.errors.midline_mm < 0.16  # .1 mm of noise in x and y; 2 % of 140 mm are 2.8 mm
