"""The declared model: fitted to all recordings, to the baseline's alone, and with the laws that these show."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial

from discovery.answer import MOST_EFFECTS
from discovery.baseline_law import MATERIAL, WATER, BaselineShows, Taken, baseline_of
from discovery.decide import PosteriorDecision, form_coarsening
from discovery.given import Deciding, Given, held_out_run
from inference.base_fit import Setting, fit_baseline_alone, fitted_order, most_coordinates, needed_order, rough_base_fit
from inference.experiment import PARAMETER_SPREAD
from inference.fit import Fit
from inference.linearise import latent_forces
from inference.motion import motion_shown
from inference.one_arm import one_arm
from inference.posterior import FORCE_SHARES
from inference.prepare import CannotTellError, Prepared, prepare
from inference.sufficient_step import sufficient_step
from inference.trajectory import Problem
from tentacle.progress import Stage

FINER = 0.5  # of the sufficient step of the declared model: added laws may need a finer one


@dataclass(frozen=True)
class DeclaredFit:
    """given: the recordings, and prepared: what is diagnosed of them. order: curvature coordinates that they show;
    paper: the fit with two. problem, fitted: with all of them; fine: the same with the steps of the search. shows: what
    the baseline says (None: there is none). taken: laws that were taken for its sake.
    """

    given: Given
    prepared: list[Prepared]
    order: int
    paper: tuple[Problem, Fit]
    problem: Problem
    fitted: Fit
    fine: Problem
    shows: BaselineShows | None
    taken: Taken | None

    @property
    def own_laws(self) -> dict[str, str]:
        """The laws that were taken, each with the sentence that says why."""
        return {} if self.taken is None else self.taken.laws

    def in_all(self, decision: PosteriorDecision) -> Taken | None:
        """The laws of an arm that a recording showed, if they alone are the answer, as laws of the arm's own; None
        without a baseline, in which they might act.
        """
        best, named = decision.leading, decision.leading.effects
        if self.shows is None or decision.verdict not in ("effect", "group"):
            return None
        if not named or not set(named) <= {*MATERIAL, *WATER} or len(self.own_laws) + len(named) > MOST_EFFECTS:
            return None
        laws = self.own_laws | {law: f"The recordings are likelier with {law} in the baseline too." for law in named}
        together = best.highest()
        return Taken(laws, best.fitted, self.order, self.shows.without, together=together)


def fit_declared(given: Given, deciding: Deciding, progress: Stage, taken: Taken | None = None) -> DeclaredFit:
    """The fits of the model that is declared in these recordings. taken: laws that were added to the declaration, and
    where the fits begin. CannotTellError where the runs leave all bounds, or where a law does not serve.
    """
    progress("reading shapes")
    prepared, setting = _prepared(given, deciding)
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
    if given.baseline:
        rough = replace(setting, experiments=problem.experiments)
        # The baseline alone says where the fit of a law of the arm's own begins.
        warm = fitted if taken is None else taken.warm
        problem, fitted = fit_baseline_alone(rough, problem.arm.order, warm=warm)
    fine = as_fitted(replace(problem, step=FINER * sufficient_step(problem, fitted)))
    shows = baseline_of(fine, fitted.nuisances, setting, taken) if given.baseline else None
    fine = _set_up_known(fine, fitted, 1.0 if shows is None else shows.error.coarsening)
    return DeclaredFit(given, prepared, order, paper, problem, fitted, fine, shows, taken)


def with_own_laws(declared: DeclaredFit, deciding: Deciding, progress: Stage) -> DeclaredFit:
    """The fit with the laws that the baseline shows, taken one after the other: each time the first that serves."""
    for more in () if declared.shows is None else declared.shows.more:
        with suppress(CannotTellError):  # with it the runs leave all bounds, or it stands at a bound
            one = fit_declared(declared.given.with_laws([more.newest]), deciding, progress, more)
            return with_own_laws(one, deciding, progress)
    return declared


def _prepared(given: Given, deciding: Deciding) -> tuple[list[Prepared], Setting]:
    """What is diagnosed, and the setting of its fits with the baseline's recordings last."""
    read = partial(prepare, device=deciding.device)
    prepared = [read(recording, hold_out=not given.held_out) for recording in given.recordings]
    prepared += [held_out_run(read(recording, hold_out=False)) for recording in given.held_out]
    complete = [read(recording, hold_out=False) for recording in given.baseline]
    complete = [replace(p, experiment=replace(p.experiment, complete=True)) for p in complete]
    prepared[0] = replace(prepared[0], words=(*prepared[0].words, *given.words))
    declaration, together = one_arm([*prepared, *complete])
    setting = Setting(declaration, tuple(p.experiment for p in together), 2)
    if len(setting.experiments) > 1:
        varies = tuple(name for name in setting.base_free() if name[0] in PARAMETER_SPREAD)
        setting = replace(setting, experiments=tuple(replace(e, varies=varies) for e in setting.experiments))
    return together[: len(prepared)], setting


def _set_up_known(problem: Problem, fitted: Fit, coarsening: float) -> Problem:
    """The problem with the coarsening that the decision will ask for at least: that of a baseline, or that for the form
    of the declared laws. What is known of the set-up is not coarsened.
    """
    if not problem.declared and not any(e.varies for e in problem.experiments):
        return problem
    forces = latent_forces(problem, fitted.parameters, fitted.nuisances)
    known = max(coarsening, form_coarsening(motion_shown(problem, fitted, forces, FORCE_SHARES[0]).nats))
    return replace(problem, experiments=tuple(replace(e, coarsening=known) for e in problem.experiments))


def as_fitted(problem: Problem) -> Problem:
    """The problem with each run simulated only as far as it is fitted."""
    experiments = []
    for e in problem.experiments:
        last = float(e.observation.t[e.used].max()) - (e.t0 if e.release is None else e.release)
        experiments.append(replace(e, duration=min(e.duration, last + 0.3)))
    return replace(problem, experiments=tuple(experiments))
