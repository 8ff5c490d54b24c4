"""Closing the loop by posterior mass, from recordings to a diagnosis (docs/loop.md).

Recordings are fitted and judged on two thirds. Their marginal likelihood is a product of predictions of each frame from
the frames before it, so it needs no second stretch. The other third, or the held-out recordings, are not used for that:
the errors before and after are stated there.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial

from affine_model.curvature import Array
from discovery.assemble import PosteriorContext, assemble_posterior
from discovery.baseline_law import Taken, baseline_of
from discovery.decide import decide_by_mass, missing_of
from discovery.detection import detection_limits
from discovery.given import Deciding, Given, held_out_run
from discovery.laws.propose import propose_laws
from discovery.laws.rivals import sought_forms, with_laws
from discovery.search import search_posterior
from discovery.side_by_side import side_by_side
from inference.base_fit import Setting, fit_baseline_alone, fitted_order, most_coordinates, needed_order, rough_base_fit
from inference.decay import fit_from_release, has_decay
from inference.discrepancy import ModelDiscrepancy, model_discrepancy, without_discrepancy
from inference.experiment import PARAMETER_SPREAD
from inference.fit import Fit
from inference.motion import motion_nats
from inference.one_arm import one_arm
from inference.posterior import (
    FORCE_SHARES,
    Hypothesis,
    declared_model,
    followed_closely,
    with_derivatives,
    with_rest,
)
from inference.prepare import CannotTellError, Prepared, prepare, recalibrated
from inference.sufficient_step import sufficient_step
from inference.trajectory import Problem
from tentacle.diagnosis import Diagnosis
from tentacle.progress import Stage

FINER = 0.5  # of the sufficient step of the declared model: added laws may need a finer one


def close_loop(given: Given, seed: int, deciding: Deciding, progress: Stage, taken: Taken | None = None) -> Diagnosis:
    """What the recordings tell; CannotTellError where they show too little. taken: what the baseline showed."""
    recordings, baseline, held_out = given.recordings, given.baseline, given.held_out
    progress("reading shapes")
    read = partial(prepare, device=deciding.device)
    prepared = [read(recording, hold_out=not held_out) for recording in recordings]
    prepared += [held_out_run(read(recording, hold_out=False)) for recording in held_out]
    complete = [read(recording, hold_out=False) for recording in baseline]
    complete = [replace(p, experiment=replace(p.experiment, complete=True)) for p in complete]
    declaration, together = one_arm([*prepared, *complete])
    prepared = together[: len(prepared)]
    setting = Setting(declaration, tuple(p.experiment for p in together), 2)
    if len(setting.experiments) > 1:
        varies = tuple(name for name in setting.base_free() if name[0] in PARAMETER_SPREAD)
        setting = replace(setting, experiments=tuple(replace(e, varies=varies) for e in setting.experiments))
    progress("fitting the declared model")
    order = needed_order(setting) if taken is None else taken.order
    setting = replace(setting, order=order)
    paper = rough_base_fit(setting, 2, warm=None if taken is None else taken.warm)
    progress("fitting the declared model", 0.4)
    problem, fitted = paper
    if order > 2:
        rough = replace(setting, experiments=problem.experiments)
        warm = fitted if taken is None else taken.warm
        problem, fitted = rough_base_fit(rough, fitted_order(order, most_coordinates(problem)), warm=warm)
    if complete:
        rough = replace(setting, experiments=problem.experiments)
        problem, fitted = fit_baseline_alone(rough, problem.arm.order, warm=fitted)
    fine = _cut(replace(problem, step=FINER * sufficient_step(problem, fitted)))
    baseline_shows = baseline_of(fine, fitted.nuisances, setting, taken) if complete else None
    for more in () if baseline_shows is None else baseline_shows.more:
        with suppress(CannotTellError):  # with it the runs leave all bounds, or it stands at a bound
            return close_loop(given.with_laws(tuple(more.laws)[-1:]), seed, deciding, progress, more)
    progress("running the reference")
    reduction = model_discrepancy(problem, fitted)
    progress("searching the catalogue")
    base = _base(fine, fitted, reduction)
    if taken is not None:
        taken.require(base)
    if baseline_shows is not None:
        base = baseline_shows.error.told(base)
    base = replace(base, motion=motion_nats(base.problem, base.fitted, base.forces, FORCE_SHARES[0]))
    found = search_posterior(
        base,
        fitted,
        lambda done: progress("searching the catalogue", done),
    )
    hypotheses = list(found.hypotheses)
    first = decide_by_mass(hypotheses)
    if baseline_shows is not None and (more := baseline_shows.in_all(first)) is not None:
        with suppress(CannotTellError):  # the recordings are likelier with these laws where they were named
            return close_loop(given.with_laws(first.leading.effects), seed, deciding, progress, more)
    leading = with_derivatives(first.leading)
    limits = detection_limits(leading, missing_of(hypotheses).temperature)
    progress("comparing")
    found = replace(found, hypotheses=tuple(_whole(h, prepared) for h in found.hypotheses))
    decision = decide_by_mass(list(found.hypotheses))
    open_loop = _open_loop(decision.leading)
    # The floor is the noise that the answer leaves: the declared model's residual may hold more.
    shown = [
        replace(p, experiment=recalibrated(replace(experiment, observation=p.experiment.observation), residuals))
        for p, experiment, residuals in zip(
            prepared, open_loop.problem.experiments, open_loop.fitted.residuals, strict=False
        )
    ]
    around = PosteriorContext(paper, shown, order, reduction, limits, {} if taken is None else taken.laws)
    answer = assemble_posterior(found, decision, open_loop, around, seed, deciding)
    own_error = decision.leading.share <= base.baseline_share
    named = sought_forms(answer, own_error) if deciding.laws else ()
    if not named:
        return answer
    base = next(h for h in found.hypotheses if not h.effects)
    alone = _open_loop(base)
    missing = propose_laws((_on_processor(alone.problem), alone.fitted), shown, progress, named)
    return with_laws(answer, missing)


def _base(problem: Problem, fitted: Fit, reduction: ModelDiscrepancy | None) -> Hypothesis:
    """The declared model, judged on the measurement with or without the reduction's error subtracted.

    The choice is the one with the larger evidence.
    """
    measured = [problem] if reduction is None else [problem, without_discrepancy(problem, reduction)]
    found = side_by_side([partial(_declared, one, fitted.nuisances) for one in measured if one is not None])
    if not found:
        raise CannotTellError("the runs of the declared model leave all bounds wherever it is fitted")
    return max(found, key=lambda h: float(h.log_evidence.max()))


def _declared(problem: Problem, nuisances: tuple[Array, ...]) -> Hypothesis:
    """The declared model fitted from here, with a decay also from its release on; the one of larger evidence."""
    found = [declared_model(problem, nuisances)]
    if has_decay(problem):
        found.append(declared_model(*fit_from_release(problem, nuisances)))
    return max(found, key=lambda h: float(h.log_evidence.max()))


def _cut(problem: Problem) -> Problem:
    """The problem with each run simulated only as far as it is fitted."""
    experiments = []
    for e in problem.experiments:
        last = float(e.observation.t[e.used].max()) - (e.t0 if e.release is None else e.release)
        experiments.append(replace(e, duration=min(e.duration, last + 0.3)))
    return replace(problem, experiments=tuple(experiments))


def _on_processor(problem: Problem) -> Problem:
    """The problem simulated on the CPU: every law that is proposed would be a kernel more to compile for a GPU."""
    return replace(problem, experiments=tuple(replace(e, device=None) for e in problem.experiments))


def _open_loop(h: Hypothesis) -> Hypothesis:
    """The hypothesis with the parameters that follow the recordings best without unknown forces.

    This is the model that is written, and its errors are stated.
    """
    known = replace(h, problem=_cut(h.problem))
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
