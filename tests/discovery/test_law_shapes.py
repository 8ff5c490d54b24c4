"""Shapes of a law refined by variable projection, and what stands beside a verdict."""

import numpy as np
import pytest

from discovery.laws.refine import RefinementProblem, RefinementStart, refined_shapes

T = np.linspace(0.0, 1.0, 400)


def answers(trials):
    """Of a bump with its place and width as shapes, one strength."""
    return np.stack([np.exp(-(((T - place) / width) ** 2)) for place, width in trials], axis=1)


def asked(target, most=10.0):
    bounds, spacing = np.array([[0.0, 1.0], [0.02, 1.0]]), np.array([0.1, 0.05])
    return RefinementProblem(answers, target, bounds, spacing, np.array([[-most, most]]))


def test_shapes_and_their_deviations_are_those_of_least_squares():
    truth, noise = np.array([0.43, 0.12]), 0.02
    errors, stated = [], []
    for seed in range(20):
        random = np.random.default_rng(seed)
        target = (3.0 * answers([truth])[:, 0] + noise * random.standard_normal(T.size)) / noise
        found, deviations = refined_shapes([RefinementStart(np.array([0.5, 0.2]), 0.0)], asked(target, 1e4))
        errors.append(found - truth)
        stated.append(deviations)
    assert np.sqrt(np.mean(np.square(errors), axis=0)) == pytest.approx(np.mean(stated, axis=0), rel=0.5)


def test_the_best_of_several_starts_is_kept():
    target = answers([(0.2, 0.05)])[:, 0] * 100.0 + answers([(0.8, 0.05)])[:, 0] * 150.0
    starts = [RefinementStart(np.array([place, 0.06]), 0.0) for place in (0.22, 0.78)]
    assert refined_shapes(starts, asked(target, 1e3))[0][0] == pytest.approx(0.8, abs=0.01)


def test_a_strength_beyond_its_bounds_is_no_answer():
    target = 100.0 * answers([(0.4, 0.1)])[:, 0]
    found, _ = refined_shapes([RefinementStart(np.array([0.5, 0.2]), 0.0)], asked(target, 1.0))
    assert found == pytest.approx([0.5, 0.2])  # where it began: nowhere is the strength within its bounds


def test_a_shape_on_its_bound_is_within_it():
    """0.11 / 0.07 * 0.07 is a rounding above 0.11: refined in grid spacings, a shape could leave its bounds."""
    bound, spacing = 0.11, 0.07
    assert (bound / spacing) * spacing > bound
    times = np.linspace(0.0, 1.0, 200)
    wanted = RefinementProblem(
        lambda trials: np.stack([np.exp(x * times) for (x,) in trials], axis=1), 30.0 * np.exp(2.0 * times),
        np.array([[0.0, bound]]), np.array([spacing]), np.array([[-1e4, 1e4]]),
    )  # fmt: skip
    found, _ = refined_shapes([RefinementStart(np.array([0.05]), 0.0)], wanted)
    assert found[0] == bound
