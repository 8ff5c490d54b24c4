"""Closing the loop by posterior mass, from recordings to a diagnosis (docs/loop.md).

Recordings are fitted and judged on two thirds. Their marginal likelihood is a product of predictions of each frame from
the frames before it, so it needs no second stretch. The other third, or the held-out recordings, are not used for that:
the errors before and after are stated there.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial

from affine_model.curvature import Array
from discovery.assemble import PosteriorContext, assemble_posterior
from discovery.decide import PosteriorDecision, decide_by_mass, log_prior_of_set, missing_of, odds_against
from discovery.declared_fit import DeclaredFit, as_fitted, fit_declared, with_own_laws
from discovery.detection import detection_limits
from discovery.given import Deciding, Given
from discovery.judged_answer import judged_answer
from discovery.laws.propose import propose_laws
from discovery.laws.rivals import sought_forms, with_laws
from discovery.search import PosteriorSearch, search_posterior
from discovery.sheared import sheared_fit
from discovery.side_by_side import side_by_side
from inference.decay import fit_from_release, has_decay
from inference.discrepancy import ModelDiscrepancy, model_discrepancy, without_discrepancy
from inference.fit import Fit
from inference.motion import motion_shown
from inference.posterior import (
    FORCE_SHARES,
    Hypothesis,
    declared_model,
    followed_closely,
    with_derivatives,
    with_rest,
)
from inference.prepare import CannotTellError, Prepared, recalibrated
from inference.trajectory import Problem
from tentacle.diagnosis import Diagnosis
from tentacle.progress import Stage


@dataclass(frozen=True)
class LoopSearch:
    """What a search beside the declared model found: its fits, the reduction's error, the base, and a first decision of
    all hypotheses.
    """

    declared: DeclaredFit
    reduction: ModelDiscrepancy | None
    base: Hypothesis
    found: PosteriorSearch
    first: PosteriorDecision

    def score(self, temperature: float) -> float:
        """Log posterior of its leading set, but for a constant, in likelihoods that are coarsened so much.

        Sections that shear are a law that acts, and cost what one costs.
        """
        leading = self.first.leading
        shears = leading.problem.arm.specimen.shear_compliance > 0.0
        prior = log_prior_of_set(len(leading.effects)) - shears * odds_against(1)
        return leading.highest() / temperature + prior


def close_loop(given: Given, seed: int, deciding: Deciding, progress: Stage) -> Diagnosis:
    """What the recordings tell; CannotTellError where they show too little."""
    plain = fit_declared(given, deciding, progress)
    sheared = sheared_fit(plain, deciding, progress)
    both = plain if sheared is None or not given.baseline else None, sheared
    found = [_searched(with_own_laws(one, deciding, progress), deciding, progress) for one in both if one is not None]
    likeliest = max(found, key=lambda one: max(h.highest() for h in one.found.hypotheses))
    temperature = missing_of(likeliest.found.hypotheses).temperature
    return _answered(max(found, key=lambda one: one.score(temperature)), seed, deciding, progress)


def _searched(declared: DeclaredFit, deciding: Deciding, progress: Stage) -> LoopSearch:
    """What the recordings lack beside the declared model and the laws that were taken."""
    problem, fitted, shows = declared.problem, declared.fitted, declared.shows
    progress("running the reference")
    reduction = model_discrepancy(problem, fitted)
    progress("searching the catalogue")
    base = _base(declared.fine, fitted, reduction)
    if declared.taken is not None:
        declared.taken.require_in_all(base)
    base = replace(base, motion=motion_shown(base.problem, base.fitted, base.forces, FORCE_SHARES[0]))
    if shows is not None:
        base = shows.error.told(base)
    found = search_posterior(base, fitted, lambda done: progress("searching the catalogue", done))
    first = decide_by_mass(list(found.hypotheses))
    if (more := declared.in_all(first)) is not None:
        with suppress(CannotTellError):  # the recordings are likelier with these laws where they were named
            in_all = fit_declared(declared.given.with_laws(first.leading.effects), deciding, progress, more)
            return _searched(in_all, deciding, progress)
    return LoopSearch(declared, reduction, base, found, first)


def _answered(searched: LoopSearch, seed: int, deciding: Deciding, progress: Stage) -> Diagnosis:
    """The answer that a search leads to, with the errors of whole runs, and with laws where none was named."""
    declared, reduction, base, found = searched.declared, searched.reduction, searched.base, searched.found
    prepared = declared.prepared
    leading = with_derivatives(searched.first.leading)
    limits = detection_limits(leading, missing_of(found.hypotheses).temperature)
    progress("comparing")
    found = replace(found, hypotheses=tuple(_whole(h, prepared) for h in found.hypotheses))
    judged = judged_answer(found, declared.paper, reduction, partial(_written, prepared))
    around = PosteriorContext(declared.paper, declared.order, limits, declared.own_laws)
    answer = assemble_posterior(found, judged, around, seed, deciding)
    own_error = judged.decision.leading.share <= base.baseline_share
    named = sought_forms(answer, own_error) if deciding.laws else ()
    if not named:
        return answer
    base = next(h for h in found.hypotheses if not h.effects)
    alone = _open_loop(base)
    missing = propose_laws((_on_processor(alone.problem), alone.fitted), judged.prepared, progress, named)
    return with_laws(answer, missing)


def _written(prepared: Sequence[Prepared], h: Hypothesis) -> tuple[Hypothesis, list[Prepared]]:
    """The hypothesis as it is written, and the recordings with the noise that it leaves: the declared model's residual
    may hold more.
    """
    written, found = _open_loop(h), []
    for p, experiment, residuals in zip(prepared, written.problem.experiments, written.fitted.residuals, strict=False):
        own = replace(experiment, observation=p.experiment.observation)
        found.append(replace(p, experiment=recalibrated(own, residuals)))
    return written, found


def _base(problem: Problem, fitted: Fit, reduction: ModelDiscrepancy | None) -> Hypothesis:
    """The declared model, judged on the measurement with or without the reduction's error subtracted.

    The choice is the one with the larger evidence.
    """
    measured = [problem] if reduction is None else [problem, without_discrepancy(problem, reduction)]
    found = side_by_side([partial(_declared, one, fitted.nuisances) for one in measured if one is not None])
    if not found:
        raise CannotTellError("the runs of the declared model leave all bounds wherever it is fitted")
    return max(found, key=lambda h: h.highest())


def _declared(problem: Problem, nuisances: tuple[Array, ...]) -> Hypothesis:
    """The declared model fitted from here, with a decay also from its release on; the one of larger evidence."""
    found = [declared_model(problem, nuisances)]
    if has_decay(problem):
        found.append(declared_model(*fit_from_release(problem, nuisances)))
    return max(found, key=lambda h: h.highest())


def _on_processor(problem: Problem) -> Problem:
    """The problem simulated on the CPU: every law that is proposed would be a kernel more to compile for a GPU."""
    return replace(problem, experiments=tuple(replace(e, device=None) for e in problem.experiments))


def _open_loop(h: Hypothesis) -> Hypothesis:
    """The hypothesis with the parameters that follow the recordings best without unknown forces.

    This is the model that is written, and its errors are stated.
    """
    known = replace(h, problem=as_fitted(h.problem))
    alone = followed_closely(known if known.alone is not None else with_rest(known)).alone
    assert alone is not None
    return replace(h, problem=replace(h.problem, parameters=alone.parameters, filters=()), fitted=alone)


def _whole(h: Hypothesis, prepared: Sequence[Prepared]) -> Hypothesis:
    """The hypothesis with whole runs, and with the measurement before the reduction's error was subtracted."""
    experiments = list(h.problem.experiments)
    for place, p in enumerate(prepared):
        own = p.experiment
        experiments[place] = replace(experiments[place], duration=own.duration, observation=own.observation)
    return replace(h, problem=replace(h.problem, experiments=tuple(experiments)))
