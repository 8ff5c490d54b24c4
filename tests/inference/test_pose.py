"""The evidence with a pose that is known more accurately is that of the filter with the smaller prior variance."""

from dataclasses import replace

import numpy as np
import pytest

from inference.evidence import evidence_beside
from inference.fit import linearised_fit
from inference.linearise import latent_forces
from inference.posterior import FORCE_SHARES, filters_at


@pytest.mark.parametrize("place", [0, 3])
@pytest.mark.parametrize("coarsening", [1.0, 4.0, 50.0])
def test_a_narrower_prior_of_the_pose_is_that_of_its_own_filter(plain, place, coarsening):
    """All unknowns and poses are Gaussian to first order, so that both ways agree to rounding."""
    forces = latent_forces(plain.problem, plain.fitted.parameters, plain.fitted.nuisances)
    problem = replace(plain.problem, filters=filters_at(forces, place))
    unknowns = np.concatenate([plain.fitted.values, *plain.fitted.nuisances])
    fitted = linearised_fit(problem, unknowns, 0)
    turned = replace(
        fitted,
        residuals=tuple(
            rows + 0.002 * _turned(force, rows) for rows, force in zip(fitted.residuals, forces, strict=True)
        ),
    )
    known = evidence_beside(problem, turned, filters_at(forces, place))
    direct = evidence_beside(problem, turned, filters_at(forces, place, coarsening))
    assert known.pose.share == FORCE_SHARES[place]
    assert known.log + known.pose.evidence_gained(coarsening) == pytest.approx(direct.log, abs=1e-3)


def _turned(force, rows):
    """What a turn of the camera by 1 rad changes in each frame's residual: the averaged cells' own, frame by frame."""
    changed = np.zeros_like(rows)
    n = force.linearised.mass.shape[0]
    cells = force.cells
    changed[cells.place] = force.seen[cells.cell, :, n] * cells.weight[:, None]
    return changed
