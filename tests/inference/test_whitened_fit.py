"""A fit whitened anew beside another share of unknown forces is the fit that was made beside that share."""

from dataclasses import replace

import numpy as np
import pytest

from inference.fit import Fit, linearised_fit
from inference.latent_force import LatentForce
from inference.linearise import latent_forces
from inference.trajectory import Problem
from inference.whitened_fit import whitened_fit, whitened_rows

SHARES = (0.002, 0.05)


@pytest.fixture(scope="module")
def forces(with_current) -> tuple[LatentForce, ...]:
    fitted = with_current.fitted
    return latent_forces(with_current.problem, fitted.parameters, fitted.nuisances)


@pytest.mark.parametrize("share", SHARES)
def test_whitening_anew_is_fitting_beside_that_share(with_current, forces, share):
    problem: Problem = with_current.problem
    fitted: Fit = with_current.fitted
    filters = tuple(force.filter(share) for force in forces)
    anew = whitened_rows(problem, fitted, filters)
    made = linearised_fit(
        replace(problem, filters=filters, parameters=fitted.parameters),
        np.concatenate([fitted.values, *fitted.nuisances]),
        0,
    )
    # The same sums of squares and products whatever the order of the rows: only rounding differs.
    np.testing.assert_allclose(anew[:, 0] @ anew[:, 0], 2.0 * made.misfit, rtol=1e-10)
    np.testing.assert_allclose(
        anew[:, 1:].T @ anew[:, 0],
        made.jacobian.T @ made.used_residuals,
        rtol=1e-8,
        atol=1e-8 * float(np.linalg.norm(made.jacobian, axis=0).max()),
    )


def test_what_is_freed_cannot_be_absorbed(with_current, forces):
    white = whitened_fit(with_current.problem, with_current.fitted, tuple(force.filter(SHARES[0]) for force in forces))
    rows = whitened_rows(with_current.problem, with_current.fitted, white.filters)
    columns = rows[:, 1:] / np.linalg.norm(rows[:, 1:], axis=0)
    assert np.abs(columns.T @ white.residual).max() < 1e-8 * np.linalg.norm(white.residual)
