"""The joint normal of a fit: its draws, its parts, and what is refused."""

import numpy as np
import pytest

from tentacle.model import Estimate, Model
from tentacle.posterior import Posterior
from tentacle.specimen import Cone, Specimen

COVARIANCE = np.array([[4.0, -1.8, 0.0], [-1.8, 1.0, 0.1], [0.0, 0.1, 0.25]])
NAMES = ("elasticity.E", "damping.eta", "drag.C_perp")


def test_draws_have_the_covariance():
    known = Posterior.of_covariance(NAMES, COVARIANCE)
    assert known is not None
    drawn = np.cov(known.draws(200_000, np.random.default_rng(3)))
    # An entry of 200000 draws has a standard error of at most sqrt(2/200000) = .32 % of its two deviations' product.
    size = np.sqrt(np.outer(np.diag(COVARIANCE), np.diag(COVARIANCE)))
    assert np.max(np.abs(drawn - COVARIANCE) / size) < 4 * 0.0032


def test_a_part_is_the_marginal():
    known = Posterior.of_covariance(NAMES, COVARIANCE)
    assert known is not None
    part = known.of(["drag.C_perp", "elasticity.E"])
    assert part is not None
    assert part.names == ("elasticity.E", "drag.C_perp")
    spread = np.diag(part.deviation)
    np.testing.assert_allclose(spread @ np.array(part.correlation) @ spread, COVARIANCE[::2, ::2], atol=1e-12)
    assert known.of(["current.U_x"]) is None
    assert Posterior.of_covariance(("a.b",), np.zeros((1, 1))) is None


def test_two_parameters_that_are_one_stay_together():
    # A singular covariance: rounding may leave it a negative eigenvalue.
    known = Posterior.of_covariance(("a.b", "a.c"), np.array([[1.0, 1.0 + 1e-12], [1.0 + 1e-12, 1.0]]))
    assert known is not None
    both = known.draws(50, np.random.default_rng(0))
    np.testing.assert_allclose(both[0], both[1], atol=1e-5)


@pytest.mark.parametrize(
    ("deviation", "correlation"),
    [
        ((1.0,), ((1.0, 0.0), (0.0, 1.0))),
        ((1.0, 0.0), ((1.0, 0.0), (0.0, 1.0))),
        ((1.0, 1.0), ((1.0, 0.2), (0.3, 1.0))),
        ((1.0, 1.0), ((1.0, 1.2), (1.2, 1.0))),
        ((1.0, 1.0), ((2.0, 0.0), (0.0, 1.0))),
        ((1.0, 1.0), ((1.0,), (0.0, 1.0))),
        ((1.0, 1.0), ((1.0, float("nan")), (float("nan"), 1.0))),
    ],
)
def test_what_is_no_correlation_is_refused(deviation, correlation):
    with pytest.raises(ValueError, match=r"deviation|correlation"):
        Posterior(("a.b", "a.c"), deviation, correlation)


def test_a_changed_parameter_leaves_the_posterior():
    known = Posterior.of_covariance(NAMES, COVARIANCE)
    parameters = {"elasticity": {"E": Estimate(2e5, 1e5, 3e5)}, "damping": {"eta": Estimate(10.0, 9.0, 11.0)}}
    model = Model(Specimen(Cone(0.01, 0.002), 0.1, 1070.0), parameters=parameters, posterior=known)
    changed = model.with_effect("elasticity", E=Estimate.exact(1e5)).posterior
    assert changed is not None
    assert changed.names == ("damping.eta", "drag.C_perp")
    assert model.with_effect("current", U_x=Estimate.exact(0.1)).posterior == known
