"""Closing the loop by rules, from recordings to a diagnosis (the protocol of docs/loop.md)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from affine_model.curvature import Array
from discovery.given import Deciding, Given, held_out_run
from discovery.laws.propose import propose_laws
from discovery.laws.rivals import seeks_laws, with_laws
from discovery.rules.assemble import RulesContext, assemble_rules
from discovery.rules.search import StepwiseSearch, stepwise_search
from discovery.rules.unnamed import unnamed_rest
from discovery.rules.verdict import decide_by_rules, structure_share
from inference.base_fit import (
    Setting,
    fit_base,
    fitted_order,
    initial_nuisances,
    most_coordinates,
    needed_order,
    refit_noise_and_step,
)
from inference.compare import unexplained_share
from inference.discrepancy import ModelDiscrepancy, model_discrepancy, without_discrepancy
from inference.hypothesis import GatedHypothesis, gated_hypothesis, noise_ratio, variance_inflation
from inference.observation import ShapeObservation
from inference.prepare import Prepared, prepare
from inference.trajectory import Fit, Problem, fit
from tentacle.diagnosis import Diagnosis
from tentacle.progress import Stage
from tentacle.recording import Recording

ALMOST_NOISE = 1.3  # noise variances: a baseline with a smaller residual counts as explained
PARTIAL = 0.5  # of the structured error: a hypothesis that leaves more is not used further
SMALL_REDUCTION = 0.2  # noise sigmas: below, one more coordinate is not worth its time
HELPS = 0.8  # more coordinates must bring the reduction's error below this share of what it was
OF_MOTION = 7e-4  # of an arm's motion: accuracy of its declared shape, of its laws and of another simulator
# Of the reduction's error after the chain's is subtracted: another simulator or a real arm differs by as much
REMAINS = 0.3


@dataclass(frozen=True)
class Baseline:
    """What recordings with a complete declaration show: the base fit, the rms (K,) of its rest in each channel, and the
    correlation time [frames] of that rest.
    """

    fitted: Fit
    rest_rms: Array
    correlation: float


def _learn_baseline(recordings: Sequence[Recording], order: int | None) -> tuple[Baseline, int]:
    """Fit the baseline. Its residual then counts as noise, with its correlation."""
    prepared = [prepare(recording, hold_out=False) for recording in recordings]
    setting = Setting(recordings[0].declaration, tuple(p.experiment for p in prepared), 2)
    order = order or needed_order(setting, complete=True)
    problem, fitted = fit_base(setting, order)
    experiments, judged = problem.experiments, gated_hypothesis((), problem, fitted)
    rows = [r[e.used] * e.noise_gain for e, r in zip(experiments, fitted.residuals, strict=True)]
    rest_rms = np.sqrt(np.mean(np.concatenate(rows) ** 2, axis=0))
    gain = np.max([e.noise_gain for e in experiments], axis=0)
    ratio = float(np.mean(rest_rms**2) / np.mean(gain**2))
    if ratio < ALMOST_NOISE:
        return Baseline(fitted, gain, 1.0), order
    correlation = max(variance_inflation(judged) / ratio, 1.0)
    again = tuple(replace(e, noise_gain=np.maximum(e.noise_gain, rest_rms)) for e in experiments)
    problem = replace(problem, experiments=again)
    return Baseline(fit(problem, fitted.nuisances), np.maximum(rest_rms, gain), correlation), order


def _with_baseline(setting: Setting, baseline: Baseline) -> Setting:
    """The experiments with the residual of the baseline counted as noise: it is not searched."""
    experiments = []
    for experiment in setting.experiments:
        if baseline.rest_rms.size == experiment.noise_gain.size:
            gain = np.maximum(experiment.noise_gain, baseline.rest_rms)
            experiment = replace(experiment, noise_gain=gain, correlation=baseline.correlation)
        experiments.append(experiment)
    return replace(setting, experiments=tuple(experiments))


def diagnose_by_rules(given: Given, seed: int, deciding: Deciding, progress: Stage) -> Diagnosis:
    """What the recordings tell; CannotTellError where they show too little."""
    calibration = deciding.calibration
    recordings, baseline, held_out = given.recordings, given.baseline, given.held_out
    progress("reading shapes")
    prepared = [prepare(recording, hold_out=not held_out) for recording in recordings]
    prepared += [held_out_run(prepare(recording, hold_out=False)) for recording in held_out]
    setting = Setting(recordings[0].declaration, tuple(p.experiment for p in prepared), 2)
    words = [sentence for p in prepared for sentence in p.words]
    known: Baseline | None = None
    if baseline:
        progress("fitting the baseline")
        # Markers show their order only by fits. The fits of the baseline do this here.
        known, order = _learn_baseline(baseline, needed_order(setting) if setting.sees_shapes() else None)
        setting = _with_baseline(setting, known)
    else:
        order = needed_order(setting)
    setting = replace(setting, order=order)

    progress("fitting the declared model")
    paper_problem, paper = _base_hypothesis(setting, 2, known)
    base_problem, base = paper_problem, paper
    if order > 2:
        fitted = fitted_order(order, most_coordinates(base_problem))
        base_problem, base = _base_hypothesis(setting, fitted, known, warm=paper)
    progress("running the reference")
    base_problem, base, reduction = _reduced_enough(setting, base_problem, base, known)
    progress("searching the catalogue")
    found = stepwise_search(_corrected(base_problem, base, reduction), setting.arm())
    found, reduction = _searched_again(found, setting, (base_problem, base), reduction)
    # With the noise of the final model. The errors are those of the measurement, with the reduction's error in it.
    final = found.chosen.problem.experiments
    prepared = [
        replace(p, experiment=replace(experiment, observation=p.experiment.observation))
        for p, experiment in zip(prepared, final, strict=True)
    ]
    decision = decide_by_rules(found, _unexplained(found, prepared, reduction))
    explained = decision.verdict != "unknown" or structure_share(found, found.chosen) < PARTIAL
    rest = None if found.chosen.train.passed else unnamed_rest(found.chosen if explained else found.base)
    progress("comparing")
    paper_model = (paper_problem, paper)
    answer = assemble_rules(
        found, decision, rest, RulesContext(paper_model, prepared, order, tuple(words), reduction), seed, calibration
    )
    if not deciding.laws or not seeks_laws(answer):
        return answer
    missing = propose_laws((found.base.problem, found.base.fitted), prepared, progress)
    return with_laws(answer, missing)


def _base_hypothesis(
    setting: Setting, order: int, known: Baseline | None, *, warm: Fit | None = None
) -> tuple[Problem, Fit]:
    if known is None:
        return fit_base(setting, order, warm=warm)
    start = known.fitted
    problem = replace(
        setting.problem(order, start.parameters),
        prior_free=start.free,
        prior_mean=start.values,
        prior_root=np.linalg.cholesky(np.linalg.inv(start.covariance)).T,
    )
    nuisances = tuple(initial_nuisances(experiment, order) for experiment in setting.experiments)
    return refit_noise_and_step(problem, fit(problem, nuisances))


def _reduced_enough(
    setting: Setting, problem: Problem, fitted: Fit, known: Baseline | None
) -> tuple[Problem, Fit, ModelDiscrepancy | None]:
    """The base with enough coordinates that its own error is below the noise, or no longer falls; and that error.

    Shapes show a coordinate only if it is larger than the noise. The chain also shows smaller ones that matter.
    """
    reduction = model_discrepancy(setting.declaration, problem, fitted)
    alone = gated_hypothesis((), problem, fitted)
    if alone.passed:
        return problem, fitted, reduction
    most = most_coordinates(problem)
    while reduction is not None and reduction.worst > SMALL_REDUCTION and problem.arm.order < most:
        more = fitted_order(problem.arm.order + 1, most)
        higher = _base_hypothesis(setting, more, known, warm=fitted)
        again = model_discrepancy(setting.declaration, *higher)
        if again is None or again.worst > HELPS * reduction.worst:
            break
        (problem, fitted), reduction = higher, again
    return problem, fitted, reduction


def _corrected(
    problem: Problem, fitted: Fit, reduction: ModelDiscrepancy | None, missing: float | None = None
) -> GatedHypothesis:
    """The base fitted to the measurement minus the reduction's error, with an allowance for the rest of that error.

    The rest grows with `missing` [noise sigmas], the error of the model with which the chain was run (None: the
    residual of the base). The measurement stays as it is, with an allowance for the whole error, if that error is
    small, is not known everywhere, or is not in these data: its subtraction then raises the misfit by half its square
    or more.
    """
    corrected = (
        None if reduction is None or reduction.worst < SMALL_REDUCTION else without_discrepancy(problem, reduction)
    )
    if reduction is None or corrected is None:
        return _with_discrepancy(problem, fitted, reduction, 1.0)
    again = refit_noise_and_step(corrected, fit(replace(corrected, parameters=fitted.parameters), fitted.nuisances))
    if again[1].misfit - fitted.misfit > 0.5 * 0.5 * reduction.structure**2 * fitted.count:
        return _with_discrepancy(problem, fitted, reduction, 1.0)
    if missing is None:
        missing = gated_hypothesis((), *again).train.structure
    return _with_discrepancy(*again, reduction, min(1.0, REMAINS + missing / max(_motion(again[0]), 1e-9)))


def _with_discrepancy(
    problem: Problem, fitted: Fit, reduction: ModelDiscrepancy | None, share: float
) -> GatedHypothesis:
    """Judge the base with an allowance for that share of the reduction's error and for OF_MOTION."""
    least = OF_MOTION * _motion(problem)
    lost = (0.0, 0.0) if reduction is None else (share * reduction.structure, share * reduction.judged)
    return gated_hypothesis((), problem, fitted, (float(np.hypot(lost[0], least)), float(np.hypot(lost[1], least))))


def _searched_again(
    found: StepwiseSearch, setting: Setting, base: tuple[Problem, Fit], reduction: ModelDiscrepancy | None
) -> tuple[StepwiseSearch, ModelDiscrepancy | None]:
    """The search and its reduction error, repeated with the reduction error of the chain that has the found effects.

    It is repeated only if the found effects explain much but still leave too much. The first search is kept if the
    second does not leave less.
    """
    chosen = found.chosen
    done = reduction is None or chosen.passed
    if done or not chosen.effects or structure_share(found, chosen) > PARTIAL:
        return found, reduction
    if chosen.problem.arm.order != base[0].arm.order:
        return found, reduction
    with_effects = model_discrepancy(setting.declaration, chosen.problem, chosen.fitted, chosen.effects)
    if with_effects is None:
        return found, reduction
    again = stepwise_search(_corrected(*base, with_effects, chosen.train.structure), setting.arm())
    noise = noise_ratio(again.chosen.problem, chosen.problem)
    better = again.chosen.passed or again.chosen.excess_rms * noise <= chosen.excess_rms
    return (again, with_effects) if better else (found, reduction)


def _unexplained(found: StepwiseSearch, prepared: list[Prepared], reduction: ModelDiscrepancy | None) -> float:
    """The share of the base's error [mm] that the chosen hypothesis leaves if the gates refuse it; otherwise 1."""
    base, chosen = found.base, found.chosen
    if not chosen.effects or chosen.passed:
        return 1.0
    lost = 0.0 if reduction is None else reduction.millimetres
    models = ((base.problem, base.fitted), (chosen.problem, chosen.fitted))
    return unexplained_share(*models, prepared, lost, held_out=bool(chosen.judged.gates))


def _motion(problem: Problem) -> float:
    """rms of the motion that shapes or markers show [noise sigmas]."""
    squares = []
    for experiment in problem.experiments:
        observation = experiment.observation
        if isinstance(observation, ShapeObservation):
            seen = observation.seen
            change = observation.coefficients[seen] - observation.coefficients[seen].mean(axis=0)
            whitened = np.einsum("tkl,tl->tk", observation.root[seen], change)
        else:
            whole = np.isfinite(observation.xy).all(axis=(1, 2))
            points = observation.xy[whole].reshape(-1, experiment.noise_gain.size)
            whitened = (points - points.mean(axis=0)) / observation.sigma if points.size else np.zeros(1)
        squares.append(float(np.mean((whitened / experiment.noise_gain) ** 2)))
    return float(np.sqrt(np.mean(squares))) if squares else 0.0
