"""The search: sets of effects ranked by linear algebra about a fitted model, and the best few refitted.

It repeats about the best of these. When a round finds no better set, each effect of the best is exchanged for others
that may explain as much (discovery.exchange), and the search ends if none of these sets is better.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from discovery.answer import MOST_EFFECTS
from discovery.begin import at_origin, begun_about, may_be_named
from discovery.decide import log_masses, missing_of, stands_at_bound
from discovery.exchange import NEGLIGIBLE_NATS, exchange_starts
from discovery.nested import Pair, nested_pairs, nested_refit, stands_in_another_valley
from discovery.rank import ranking
from discovery.refits import added, removed
from discovery.side_by_side import side_by_side
from discovery.where import fit_where_it_acts
from inference.decay import has_decay
from inference.fit import Fit
from inference.latent_force import LatentForce
from inference.posterior import Hypothesis, RoughFit, continued, with_derivatives, with_rest, without_derivatives
from inference.score import Candidate
from tentacle.solver_result import RESULTS

ROUNDS = 6
FAR, ROOM = 15.0, 0.5  # nats, or share of what the best rough fit gains, behind which no close fit catches up
FOR_A_SHAPE = 3.0  # nats: what a fitted shape must gain over its neutral value; chosen on the silicone beam

Tried = dict[frozenset[str], Hypothesis]


@dataclass(frozen=True)
class PosteriorSearch:
    """The base, all hypotheses that were refitted (the base first), and the candidates as the base's residual ranks
    them.
    """

    base: Hypothesis
    hypotheses: tuple[Hypothesis, ...]
    candidates: tuple[Candidate, ...]


def search_posterior(
    base: Hypothesis, origin: Fit, progress: Callable[[float], None] = lambda _: None
) -> PosteriorSearch:
    """Hypotheses about what the base lacks. origin: where the base's own fit began. Effects begin there too, because in
    a decay the base's fit may be far from the valley of any effect.
    """
    tried = _with_rests({frozenset(): base})
    base = tried[frozenset()]
    first: tuple[Candidate, ...] = ()
    centre, decays, begun_within = base, has_decay(base.problem), set[Pair]()
    for number in range(ROUNDS):
        missing = missing_of(list(tried.values()))
        temperature, least = missing.temperature, missing.least_temperature
        promised = ranking(centre, MOST_EFFECTS - len(centre.effects), temperature)
        first = first or promised.candidates
        wanted = [
            begun
            for begun in begun_about(centre, promised, centre if number else at_origin(base, origin), least)
            if is_fitted_anew((*centre.effects, *begun.chosen.names), centre, tried)
            and (decays or may_be_named(begun, centre, least))
        ]
        tasks: list[Callable[[], RoughFit]] = [
            *(partial(added, centre, begun) for begun in wanted),
            *(partial(removed, centre, name) for name in centre.effects if len(centre.effects) > 1 or decays),
        ]
        promising = _promising(side_by_side(tasks))
        found = side_by_side([partial(_fitted, one, base.forces, temperature) for one in promising])
        tried = _with_rests(_with(tried, _best_with_rest(tried, found)))
        progress((number + 1.0) / ROUNDS)
        if _leading(tried).effects == centre.effects:
            tried = _with_rests(_with(tried, _exchanged(centre, tried, temperature)))
            # A decay's rough fits stand beside forces of their own, so that what they leave does not compare.
            pairs = [pair for pair in nested_pairs(tried, FAR) if pair not in begun_within and not decays]
            begun_within |= set(pairs)
            tried = _with_rests(_with(tried, _nested(tried, pairs, base.forces, temperature)))
            if _leading(tried).effects == centre.effects:
                break
        centre = with_derivatives(_leading(tried))
    return PosteriorSearch(tried[frozenset()], tuple(tried.values()), first)


def is_fitted_anew(effects: tuple[str, ...], centre: Hypothesis, tried: Tried) -> bool:
    """Whether a set that contains the centre's is to be fitted: it is not yet, or its fit has less evidence than the
    centre. The larger model contains the smaller one, so that this fit ended in another valley.
    """
    known = tried.get(frozenset(effects))
    return known is None or known.highest() < centre.highest() - FAR


def _leading(tried: Tried) -> Hypothesis:
    """The hypothesis with the largest mass."""
    missing = missing_of(list(tried.values()))
    return max(tried.values(), key=lambda h: max(log_masses(h, missing)))


def _with(tried: Tried, found: list[Hypothesis]) -> Tried:
    """The hypotheses with those that were found; of two fits of one set, the preferred one."""
    temperature, base = missing_of([*tried.values(), *found]).temperature, tried[frozenset()]
    together = dict(tried)
    for h in found:
        if not h.effects:  # a decay's base, fitted from where an effect had left it
            told = ("baseline_share", "baseline_rest", "baseline_coarsening", "motion")
            h = replace(h, **{name: getattr(base, name) for name in told})
        known = together.get(frozenset(h.effects))
        together[frozenset(h.effects)] = h if known is None else _preferred(h, known, temperature)
    return together


def _exchanged(centre: Hypothesis, tried: Tried, temperature: float) -> list[Hypothesis]:
    """The sets in which one of several effects of the centre is exchanged for another, and those without it."""
    if len(centre.effects) < 2:
        return []
    declared, sets = tried[frozenset()].forces, {e: frozenset(centre.effects) - {e} for e in centre.effects}
    anew = side_by_side([
        lambda effect=effect: _fitted(removed(centre, effect), declared, temperature)
        for effect, one in sets.items()
        if one not in tried
    ])  # fmt: skip
    fewer = [with_derivatives(h) for h in (*(tried[one] for one in sets.values() if one in tried), *anew)]
    tasks = [
        lambda place=place, without=without, one=one: (place, added(without, one))
        for place, without in enumerate(fewer)
        for one in exchange_starts(centre, without, temperature)
        if is_fitted_anew((*without.effects, *one.chosen.names), without, tried)
    ]
    roughs = side_by_side(tasks)
    promising = [
        one for place in range(len(fewer)) for one in _promising([rough for own, rough in roughs if own == place])
    ]
    found = side_by_side([partial(_fitted, one, declared, temperature) for one in promising])
    return [*map(without_derivatives, anew), *found]


def _nested(tried: Tried, pairs: list[Pair], declared: tuple[LatentForce, ...], temperature: float) -> list[Hypothesis]:
    """The smaller sets of the pairs, fitted from where the larger ones stand, where that is another valley."""
    roughs = side_by_side([nested_refit(tried, pair) for pair in pairs])
    better = [
        rough
        for (effects, _), rough in zip(pairs, roughs, strict=True)
        if stands_in_another_valley(tried[effects], rough, FAR)
    ]
    return side_by_side([partial(_fitted, one, declared, temperature) for one in better])


def _fitted(rough: RoughFit, declared: tuple[LatentForce, ...], temperature: float) -> Hypothesis:
    """The hypothesis, fitted closely. Dozens are kept, so that their derivatives are not."""
    return without_derivatives(fit_where_it_acts(rough, declared, temperature))


def _continued(h: Hypothesis) -> Hypothesis:
    return without_derivatives(continued(h))


def _preferred(h: Hypothesis, known: Hypothesis, temperature: float) -> Hypothesis:
    """The one of two fits of a set with the larger evidence; a shape is fitted only where the evidence, coarsened like
    the decision's, asks for it.
    """
    few, more = sorted((h, known), key=lambda one: len(one.problem.free))
    asked = FOR_A_SHAPE * temperature if len(few.problem.free) < len(more.problem.free) else 0.0
    return more if more.highest() > few.highest() + asked else few


def _best_with_rest(tried: Tried, found: list[Hypothesis]) -> list[Hypothesis]:
    """What was found; the best, where it is better than all before, with the rest that it leaves. The coarsening of the
    decision depends on it, and with that whether a shape is worth its price: one that is given up is not tried again.
    """
    best = max((h for h in found if not stands_at_bound(h)), key=lambda h: h.highest(), default=None)
    if best is None or best.alone is not None or best.highest() <= max(h.highest() for h in tried.values()):
        return found
    known = with_rest(best, tried[frozenset()])
    return [known if h is best else h for h in found]


def _with_rests(tried: Tried) -> Tried:
    """The hypotheses, those that may count fitted to an end, and with the rest that they leave."""
    creeping = [h for h in _that_may_count(tried) if h.fitted.result is RESULTS.MAX_STEPS]
    tried = _with(tried, side_by_side([partial(_continued, h) for h in creeping]))
    asked = [h for h in _that_may_count(tried) if h.alone is None]
    base = tried[frozenset()]
    base = base if base.alone is not None else with_rest(base)
    found = side_by_side([partial(with_rest, h, base) for h in asked])
    return tried | {frozenset(): base} | {frozenset(h.effects): h for h in found}


def _that_may_count(tried: Tried) -> list[Hypothesis]:
    """The sets of effects whose mass is no more than NEGLIGIBLE_NATS behind the largest."""
    missing = missing_of(list(tried.values()))
    masses = {effects: max(log_masses(h, missing)) for effects, h in tried.items()}
    least = max(masses.values()) - NEGLIGIBLE_NATS
    return [h for effects, h in tried.items() if effects and masses[effects] > least]


def _promising(roughs: list[RoughFit]) -> list[RoughFit]:
    """Those that may still be the best when they are fitted closely, and the best of each number of effects: more
    effects leave less, whatever acts.
    """
    sets: dict[tuple[str, ...], float] = {}
    best: dict[int, float] = {}
    for one in roughs:
        sets[one.effects] = min(one.cost, sets.get(one.effects, np.inf))
        best[len(one.effects)] = min(one.cost, best.get(len(one.effects), np.inf))
    costs = np.array(list(sets.values()))
    least, most = (costs.min(), costs.max()) if costs.size else (0.0, 0.0)
    reach = least + max(FAR, ROOM * (most - least))
    return [one for one in roughs if one.cost <= max(reach, best[len(one.effects)])]
