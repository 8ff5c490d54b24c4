"""A fit at a coarser step ends where the fit at the problem's own step does."""

from dataclasses import replace

import numpy as np
import pytest

from inference.deferred_correction import Effort, coarser, corrected, minimised_at_step
from inference.fit import minimised
from inference.trajectory import RAN_AWAY, Problem


@pytest.fixture(scope="module")
def begun(with_current) -> tuple[Problem, np.ndarray]:
    """A problem with a step of 1/600 s away from its minimum, and its unknowns."""
    fitted = with_current.fitted
    problem = replace(with_current.problem, step=1.0 / 600.0, parameters=fitted.parameters, filters=())
    values = fitted.values * 1.05
    parameters = fitted.parameters.copy()
    parameters[problem.rows()] = values
    return replace(problem, parameters=parameters), np.concatenate([values, *fitted.nuisances])


def test_where_it_was_corrected_the_residuals_are_those_of_the_fine_step(begun):
    problem, unknowns = begun
    coarse = corrected(problem, unknowns)
    assert coarse.step == coarser(problem) * problem.step
    here = unknowns[:, None]
    # The sum (a - b) + b in double precision: relative rounding of some 1e-16, residuals of some 10 sigmas.
    np.testing.assert_allclose(coarse.residuals(here)[0], problem.residuals(here)[0], atol=1e-11)


def test_it_ends_at_the_minimum_of_the_fine_step(begun, with_current):
    problem, _ = begun
    nuisances = with_current.fitted.nuisances
    exact, lowest = minimised(problem, nuisances, tolerance=1e-7, most=40)
    found, corrected_lowest, _ = minimised_at_step(problem, nuisances, Effort(tolerance=1e-7))
    # A correction that is right to SETTLED nats shifts a minimum's unknowns by at most sqrt(2 SETTLED) = .2 sigmas.
    sigma = np.sqrt(np.diag(with_current.fitted.covariance))
    count = len(problem.free)
    assert np.all(np.abs(found - exact)[:count] < 0.2 * sigma)
    assert corrected_lowest.cost == pytest.approx(lowest.cost, abs=0.02)
    # Without a correction the coarse step itself has another minimum: this is what the correction takes away.
    coarse = replace(problem, step=coarser(problem) * problem.step)
    assert abs(minimised(coarse, nuisances, tolerance=1e-7, most=40)[1].cost - lowest.cost) > 0.02


def test_near_where_the_coarse_run_leaves_all_bounds_there_is_no_coarser_step(begun):
    problem, unknowns = begun
    coarse = replace(problem, step=coarser(problem) * problem.step)
    place = problem.free.index(("elasticity", "E"))

    def stiffer(factor: float) -> np.ndarray:
        return np.concatenate([unknowns[:place], [factor * unknowns[place]], unknowns[place + 1 :]])

    def runs_away(factor: float) -> bool:
        return max(np.abs(rows).max() for rows in coarse.residuals(stiffer(factor)[:, None])[1]) >= RAN_AWAY

    below, above = 1.0, 2.0
    while not runs_away(above):
        below, above = above, 2.0 * above
    for _ in range(16):
        middle = 0.5 * (below + above)
        below, above = (below, middle) if runs_away(middle) else (middle, above)
    # Derivatives are taken 1e-3 of a typical stiffness to both sides, farther than 2^-16 of the bracket.
    assert corrected(problem, stiffer(below)) is problem
    assert corrected(problem, stiffer(0.5 * below)).step == coarse.step


def test_where_the_correction_leads_uphill_the_fit_goes_on_at_its_own_step(with_current):
    # The arm is so stiff that a step of 1/150 s is half of what lets its runs leave all bounds.
    problem = replace(
        with_current.problem, step=1.0 / 300.0, parameters=with_current.fitted.parameters.copy(), filters=()
    )
    stiff, damped = (problem.rows()[problem.free.index(name)] for name in (("elasticity", "E"), ("damping", "eta")))
    problem.parameters[stiff] *= 75.0
    unknowns = np.concatenate([problem.parameters[problem.rows()], *with_current.fitted.nuisances])
    (experiment,) = problem.experiments
    rows = problem.residuals(unknowns[:, None])[1][0][:, :, 0] * experiment.noise_gain
    exact = replace(experiment, observation=experiment.observation.subtract_residual(rows))
    parameters = problem.parameters.copy()
    parameters[stiff] *= 0.97
    parameters[damped] *= 0.5
    begun = replace(problem, experiments=(exact,), parameters=parameters)
    found, lowest, at_end = minimised_at_step(begun, with_current.fitted.nuisances, Effort(tolerance=5e-5))

    def cost(there: np.ndarray) -> float:
        return 0.5 * float(np.sum(begun.residuals(there[:, None])[0] ** 2))

    start = np.concatenate([parameters[begun.rows()], *with_current.fitted.nuisances])
    # The data are the model's own, so that the truth costs its priors alone; the corrected fit ended above its start.
    assert cost(start) > 10.0
    assert cost(found) < cost(unknowns)
    assert lowest.cost == pytest.approx(cost(found), rel=1e-9)
    assert at_end.step == begun.step
