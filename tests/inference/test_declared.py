"""Declared numbers with a spread: data that know them find them; data that do not leave them as declared."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from inference.base_fit import Setting, fit_base
from inference.declared_words import IMITATED, declared_words
from inference.estimates import declared_deviations
from inference.fit import Fit, linearised_fit
from inference.identify import identify
from inference.initial_state import initial_nuisances
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
    words = declared_words(problem, fitted)
    assert any(LENGTH in sentence and "the data say" in sentence for sentence in words)
    assert declared_words(problem, fitted, imitates=True) == [*words, IMITATED]


def test_a_number_that_the_motion_does_not_show_keeps_its_declared_spread(recorded) -> None:
    """In air stiffness, damping and density appear as ratios only: gravity aside, no motion tells the density."""
    number = Uncertain(DENSITY, SPECIMEN.density, 50.0, 10.0)
    recording = declared_as(recorded(seconds=6.0), number)
    floating = replace(recording.declaration.gravity, magnitude=0.0)
    declaration = replace(recording.declaration, gravity=floating, fluid=AIR)
    problem, fitted = fitted_to(replace(recording, declaration=declaration))
    place = fitted.free.index(("declared", DENSITY))
    assert np.isclose(np.sqrt(fitted.covariance[place, place]), 50.0, rtol=0.02)  # the prior alone, to rounding
    (silent,) = declared_words(problem, fitted, imitates=True)  # where nothing is said, nothing has to be doubted
    assert silent.endswith("say nothing about it.")


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
    # In a fit that the decision will coarsen, the declaration has T times its weight, which is taken off again.
    coarse = replace(problem, experiments=tuple(replace(e, coarsening=18.0) for e in problem.experiments))
    heavier = linearised_fit(coarse, np.concatenate([fitted.values, *fitted.nuisances]), 0)
    assert np.isclose(declared_deviations(coarse, heavier, 18.0)[LENGTH], told**-0.5, rtol=1e-6)


def test_before_a_decision_that_coarsens_the_declaration_weighs_as_much_more(recorded) -> None:
    """p(y)^(1/T) p(d) = [p(y) p(d)^T]^(1/T): a Gaussian to the power of T is one of sd / sqrt(T)."""
    number = Uncertain(LENGTH, 0.136, 0.005, 1e-6)
    setting = Setting(
        with_values(recorded(seconds=6.0).declaration, {LENGTH: 0.136}),
        (prepare(declared_as(recorded(seconds=6.0), number), hold_out=False).experiment,),
        2,
    )
    varies = (("elasticity", "E"),)
    problem = setting.problem(2, setting.start())
    (experiment,) = problem.experiments
    coarse = replace(experiment, varies=varies, coarsening=9.0)
    problem = replace(problem, declared=(number,), parameters=np.append(problem.parameters, 0.136))
    problem = replace(problem, free=(*problem.free, ("declared", LENGTH)))
    unknowns = np.concatenate([problem.parameters[problem.rows()], initial_nuisances(coarse, 2)])
    moved = unknowns.copy()
    moved[len(problem.free) - 1] += 0.002  # .4 declared deviations
    moved[-1] += 0.02  # 2 deviations of a stiffness between recordings
    told = []
    for one in (replace(coarse, coarsening=1.0), coarse):
        rows = replace(problem, experiments=(one,)).residuals(np.stack([unknowns, moved], axis=1))[0]
        told.append(rows[[-1, -2], 1] - rows[[-1, -2], 0])
    np.testing.assert_allclose(told[0], [0.4, 2.0], rtol=1e-9)
    np.testing.assert_allclose(told[1], [1.2, 6.0], rtol=1e-9)


def test_individuals_that_are_declared_differently_are_simulated_together_as_each_alone(recorded) -> None:
    """Two recordings of one arm: shared numbers, one of the second's own, and markers that need no run of their own."""
    first, second = (replace(as_markers(recorded(seconds=s)), name=f"at_{s:g}_s") for s in (4.0, 5.0))
    numbers = (
        Uncertain(LENGTH, SPECIMEN.length, 0.002, 1e-6),
        Uncertain("gravity.angle_rad", 0.0, 0.02, only_in=second.name),
        Uncertain(f"markers.{second.markers.names[0]}.s", float(second.markers.s[0]), 0.01, only_in=second.name),
    )
    experiments = tuple(prepare(one, hold_out=False).experiment for one in (first, second))
    setting = Setting(first.declaration, experiments, 2)
    problem = setting.problem(2, setting.start())
    means = [number.value for number in numbers]
    problem = replace(
        problem,
        declared=numbers,
        free=(*problem.free, *(("declared", number.name) for number in numbers)),
        parameters=np.append(problem.parameters, means),
    )
    begin = np.concatenate([problem.parameters[problem.rows()], *(initial_nuisances(e, 2) for e in experiments)])
    moved = begin[:, None] + np.diag(1e-3 * problem.scales())  # every unknown by itself
    together, everything = problem.residuals(moved)
    alone = [problem.residuals(column[:, None]) for column in moved.T]
    # One individual or many in a batch: the kernel's sums differ by rounding.
    np.testing.assert_allclose(together, np.concatenate([one[0] for one in alone], axis=1), rtol=1e-9, atol=1e-7)
    for k, rows in enumerate(everything):
        np.testing.assert_allclose(rows, np.concatenate([one[1][k] for one in alone], axis=2), rtol=1e-9, atol=1e-7)
    own = len(problem.free) - 2  # gravity in the second recording moves nothing in the first
    centre = problem.residuals(begin[:, None])[1]
    np.testing.assert_array_equal(everything[0][:, :, own], centre[0][:, :, 0])
    assert np.abs(everything[1][:, :, own] - centre[1][:, :, 0]).max() > 1e-4
    assert np.abs(everything[1][:, :, own + 1] - centre[1][:, :, 0]).max() > 1e-4


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
