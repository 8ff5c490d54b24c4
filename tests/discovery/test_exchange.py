"""Twins beside another effect: each is fitted, so that the answer can say that the data cannot tell them apart."""

import pytest

from affine_model.arm import parameter_index
from discovery.begin import Begun
from discovery.exchange import exchange_starts
from discovery.rank import RankedSet, ranking
from discovery.refits import added
from discovery.search import search_posterior
from discovery.starts import base_follows, refit_starts
from inference.posterior import Hypothesis, declared_model, fit_hypothesis
from tests.made_recordings import base_of

LAG = 0.004  # s; at the fastest 1.9 Hz a lag of the first order then differs from a delay by .1 % of the amplitude
HIDDEN = {("current", "U_x"): 0.03, ("servo_lag", "tau"): LAG}


def with_effect(centre: Hypothesis, name: str) -> Hypothesis:
    """The hypothesis with one effect more, fitted from its best starts."""
    (candidate,) = (c for c in ranking(centre, 1).candidates if c.effect.name == name)
    chosen = RankedSet((candidate,), 0.0, (candidate.strengths,))
    starts = refit_starts(centre, chosen, base_follows(centre, centre))
    return fit_hypothesis(added(centre, Begun(chosen, (), tuple(starts))), centre.forces)


@pytest.fixture(scope="module")
def base(recorded):
    alone = base_of(recorded(HIDDEN))
    return declared_model(alone.problem, alone.fitted.nuisances)


def test_what_may_replace_an_effect_is_what_looks_like_it(base):
    """A lag of 4 ms and a clock that is 4 ms late are alike; a payload explains none of it."""
    current = with_effect(base, "current")
    both = with_effect(current, "servo_lag")
    begun = {one.chosen.names[0]: one for one in exchange_starts(both, current, 1.0)}
    assert "time_offset" in begun
    assert "servo_lag" not in begun  # it is the effect that is exchanged
    assert not {"tip_mass", "skin_drag", "soft_spot"} & set(begun)
    late = begun["time_offset"].starts[0].parameters[parameter_index("time_offset", "offset")]
    assert late == pytest.approx(-LAG, rel=0.5)  # where the refit begins, not where it ends


@pytest.mark.long
def test_the_search_fits_the_twin_beside_the_other_effect(base):
    found = {frozenset(h.effects) for h in search_posterior(base, base.fitted).hypotheses}
    assert {frozenset({"current", "servo_lag"}), frozenset({"current", "time_offset"})} <= found
