"""Search methods on functions whose maximum is known, and the search's loop: seeded, resumable, and clear about what it
cannot do.
"""

import numpy as np
import pytest

from affine_model.swim import (
    METHODS,
    OBJECTIVES,
    GaitLimits,
    SearchPlan,
    assumed_model,
    paper_cone,
    search,
    search_box,
    trial_of,
)
from affine_model.swim.pareto import not_dominated
from tentacle.errors import InputError

TRIAL = trial_of(assumed_model(paper_cone(0.21), "dragon-skin-10"), GaitLimits())
BOX = search_box(TRIAL.limits)
CENTRE = np.array([0.3, 0.6, 0.5, 0.2, 0.7, 0.4, 0.9, 0.1, 0.5])


def bowl(unit):
    distance = unit - CENTRE[:, None]
    distance[6:] -= np.round(distance[6:])  # phases go around
    return -np.sum(distance**2, axis=0)


def best_of(method, seed, evaluations=3000):
    searcher, tried, course = METHODS[method](seed), 0, []
    while tried < evaluations:
        unit = searcher.ask()
        values = bowl(unit.copy())
        searcher.tell(unit, values)
        tried += len(values)
        course.append(float(np.max(values)))
    return np.array(course)


def test_cmaes_finds_a_maximum_to_the_last_digits_and_others_come_near():
    # On a bowl in 9 dimensions CMA-ES gains a digit in about 100 evaluations a run; 3000 random points come to about
    # 0.1 a coordinate.
    assert np.max(best_of("cmaes", 1)) > -1e-4
    assert np.max(best_of("ga", 1)) > -0.1
    assert np.max(best_of("random", 1)) > -0.4


def test_a_mutation_rate_a_gene_and_an_individual_differ_as_said():
    """With crossover between twins switched off by a uniform population, only mutants differ from their parents."""
    for name, expected in (("ga", 0.02 * 9), ("ga-individual", 0.02)):
        searcher, redrawn, mutants = METHODS[name](4), 0, 0
        for _ in range(2000):
            unit = searcher.ask()
            same = np.full_like(unit, 0.5)
            searcher.tell(same, np.zeros(unit.shape[1]))
            redrawn += int(np.sum(searcher.ask() != 0.5))
            mutants += 9  # 50 less an elite of 3, less 38 crossed
        # Poisson: 3240 and 360 genes are expected, three standard deviations are allowed.
        assert redrawn / mutants == pytest.approx(expected, rel=3.0 / np.sqrt(expected * mutants))


def test_the_genetic_algorithm_keeps_its_elite():
    course = best_of("ga", 2)
    assert np.all(np.diff(course) >= 0.0)


@pytest.mark.parametrize("method", METHODS)
def test_batches_are_seeded_and_fill_the_kernel(method):
    first, second, other = (METHODS[method](seed).ask() for seed in (7, 7, 8))
    assert np.array_equal(first, second)
    assert not np.array_equal(first, other)
    assert first.shape[0] == 9
    assert first.shape[1] >= 48


@pytest.mark.parametrize("method", METHODS)
def test_an_interrupted_search_goes_on_as_if_it_had_not_been(method):
    def run(evaluations, noted=()):
        return list(search(TRIAL, OBJECTIVES["thrust"], BOX, SearchPlan(method, evaluations, 3, noted)))

    whole, part = run(200), run(100)
    resumed = run(200, [generation.scores for generation in part])
    assert len(resumed) == len(whole)
    for one, other in zip(whole, resumed, strict=True):
        assert np.array_equal(one.unit, other.unit)
        assert np.array_equal(one.scores, other.scores)
    assert resumed[-1].best_score == whole[-1].best_score


def test_unknown_method_and_foreign_notes_are_one_line():
    with pytest.raises(InputError, match="'hillclimb' is not known"):
        next(search(TRIAL, OBJECTIVES["thrust"], BOX, SearchPlan("hillclimb", 50)))
    with pytest.raises(InputError, match="another search"):
        next(search(TRIAL, OBJECTIVES["thrust"], BOX, SearchPlan("ga", 50, noted=[np.zeros(48)])))


def test_front_is_what_no_other_beats():
    random = np.random.default_rng(0)
    speed, power = random.random(200), random.random(200)
    kept = set(not_dominated(speed, power).tolist())
    for i in range(200):
        beaten = np.any((speed >= speed[i]) & (power <= power[i]) & ((speed > speed[i]) | (power < power[i])))
        assert (i in kept) == (not beaten)
