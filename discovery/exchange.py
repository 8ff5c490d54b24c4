"""Exchanges: one effect of the leading set replaced by others that may explain as much.

    promise(f | S - e) > E(S) - E(S - e) - T NEGLIGIBLE_NATS

S: the leading set; e: one of its effects; E: log evidence; T: the coarsening of the decision (discovery.decide). A
search that adds and removes one effect at a time passes by twins: of two effects that explain the same, it adds one,
and the other is never fitted beside the rest of the set. Source: Miller 2002, Subset Selection in Regression
(sequential replacement).
"""

from __future__ import annotations

from discovery.begin import Begun, begun_about
from discovery.rank import Ranking, ranking
from inference.posterior import Hypothesis

NEGLIGIBLE_NATS = 12.0  # nats behind the best: what lies further behind holds no mass, whatever it leaves


def exchange_starts(centre: Hypothesis, without: Hypothesis, temperature: float) -> list[Begun]:
    """Effects that may replace what a hypothesis lacks of the centre, and where their refits begin."""
    promised = ranking(without, 1, temperature)
    gained = centre.highest(temperature) - without.highest(temperature)
    asked = gained - NEGLIGIBLE_NATS * temperature
    alike = {one.names[0] for one in promised.sets if one.evidence > asked} - set(centre.effects)
    if not alike:
        return []
    candidates = tuple(one for one in promised.candidates if one.effect.name in alike)
    sets = tuple(one for one in promised.sets if one.names[0] in alike)
    return begun_about(without, Ranking(candidates, sets), without, temperature)
