"""The evidence between the shares at which it is computed is what the filter gives there."""

import numpy as np
import pytest

from inference.evidence import evidence_beside
from inference.posterior import FORCE_SHARES, declared_model


@pytest.fixture(scope="module")
def lacking(with_current):
    """The declared model of a recording with a current that it lacks: it needs some unknown force."""
    return declared_model(with_current.problem, with_current.fitted.nuisances)


def exact(h, share):
    return evidence_beside(h.problem, h.fitted, tuple(force.filter(share) for force in h.forces)).log


def test_the_profile_is_the_evidence_halfway_between_the_shares(lacking):
    """The decision coarsens the evidence by 5 or more, so that an error of a nat is a fifth of one there."""
    halfway = np.sqrt(FORCE_SHARES[:-1] * FORCE_SHARES[1:])
    fine, values = lacking.profile()
    interpolated = np.interp(np.log(halfway), np.log(fine), values)
    computed = np.array([exact(lacking, share) for share in halfway])
    counts = computed > computed.max() - 100.0
    assert counts.sum() >= 3
    np.testing.assert_allclose(interpolated[counts], computed[counts], atol=1.0)


def test_the_most_likely_share_need_not_be_one_that_was_computed(lacking):
    """No share nearby has more evidence, computed anew, than the one that the profile names."""
    assert np.abs(np.log(FORCE_SHARES / lacking.share)).min() > 0.0
    at_best = exact(lacking, lacking.share)
    assert at_best == pytest.approx(lacking.highest(), abs=1.0)
    assert at_best > max(exact(lacking, factor * lacking.share) for factor in (0.7, 1.4))
