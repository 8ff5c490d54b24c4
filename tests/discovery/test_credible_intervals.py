"""The interval of a parameter holds over all credible sets of effects."""

import pytest

from discovery.assemble import _quantile
from tentacle.model import Estimate


def test_one_set_gives_its_own_interval():
    alone = [(Estimate(1.0, 0.0, 2.0, "kg"), 0.7)]
    # 1.96 deviations hold 95 % to 1e-5.
    assert _quantile(alone, 0.025) == pytest.approx(0.0, abs=1e-4)
    assert _quantile(alone, 0.975) == pytest.approx(2.0, abs=1e-4)


def test_two_sets_that_differ_widen_it_by_their_masses():
    near, far = Estimate(1.0, 0.9, 1.1, "kg"), Estimate(3.0, 2.9, 3.1, "kg")
    assert _quantile([(near, 0.5), (far, 0.5)], 0.975) > 2.95
    # A set of 1 % of the mass lies outside a 95 % interval.
    assert _quantile([(near, 0.99), (far, 0.01)], 0.975) < 1.2
