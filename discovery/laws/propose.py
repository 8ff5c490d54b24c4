"""Proposals: the search's best laws, each fitted as an effect of the model through the compiled kernel, and judged on
frames that neither search nor fit used.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from affine_model.arm import Arm, neutral_parameters, parameter_index, parameter_rows
from affine_model.curvature import Array
from discovery.given import SERVO_UNDER_LOAD
from discovery.laws.along import force_map
from discovery.laws.law_words import experiment_of, missing_words
from discovery.laws.operating_point import EVERY_FORM, Searched, arms_of, settled_search, sought_at
from discovery.laws.over import over_coordinates
from discovery.laws.search import FittedLaw
from discovery.laws.words import by_kind, title_of
from discovery.next_experiment import propose_experiment
from discovery.side_by_side import side_by_side
from inference.base_fit import most_coordinates
from inference.compare import midline_error
from inference.fit import Fit, fit
from inference.missing_force import SeenMotion, lacking
from inference.more_coordinates import with_coordinates
from inference.prepare import Prepared
from inference.prior import laplace_evidence
from inference.trajectory import RAN_AWAY, ParameterName, Problem
from tentacle.law.in_use import using
from tentacle.law.written_law import WrittenLaw, WrittenParameter
from tentacle.proposed_law import LawExperiment, MissingForce, ProposedLaw

FITTED, MOST = 8, 5  # laws that are fitted, and that are shown
EXPLAINS = 0.9  # largest share of the missing force's answer that a law may leave and still be fitted
RIVAL = 1.1  # of the best law's error on held-out frames: a law within it is its rival
FIT_ROUNDS, FIT_TOLERANCE = 25, 1e-4
CLOSE_ROUNDS, CLOSE_TOLERANCE = 200, 1e-6
LEAST_FORCE = 0.25  # noise deviations rms of the missing force's answer, below which nothing is sought
GAIN = 20.0  # nats beyond its price that a law must bring
AWAY = "the motion with it leaves all bounds"


def propose_laws(
    base: tuple[Problem, Fit],
    prepared: list[Prepared],
    progress: Callable[[str], None] = lambda _: None,
    named: tuple[str, ...] = EVERY_FORM,
) -> MissingForce:
    """The missing force of a fitted model, and laws for it of the forms whose names begin so; empty where every
    recording is complete.
    """
    progress("smoothing the missing force")
    motions, sought = sought_at(base)
    if not motions:
        return MissingForce()
    names = [e.name for e in base[0].experiments if not e.complete]
    arms = arms_of(*base)
    maps = tuple(force_map(*one) for one in zip(names, arms, motions, strict=True))
    if not sought.ran_away and sought.size < LEAST_FORCE:
        return MissingForce(maps, (), (), ("The missing force does not stand out of the noise: no law is proposed.",))
    progress("searching laws for it")
    if (searched := settled_search(base, motions, named)) is None:
        return MissingForce(maps, (), (), ("Small motions about the model run away: no law is proposed.",))
    found = searched.laws
    maps = tuple(force_map(*one) for one in zip(names, arms, searched.motions, strict=True))
    found_by_kind = by_kind(found)
    kinds = tuple((kind, laws[0].unexplained) for kind, laws in found_by_kind.items())
    worth = [one for one in found if one.evidence > GAIN and one.unexplained < EXPLAINS][:FITTED]
    if not worth:
        over = over_coordinates(names[0], arms[0], searched.motions[0])
        return MissingForce(maps, (), kinds, missing_words((), found_by_kind, {}, over), over=over)
    progress("fitting the best laws")
    fits = _fitted(base, searched, prepared, worth)
    if fits.motions:
        maps = tuple(force_map(*one) for one in zip(names, arms, fits.motions, strict=True))
    over = over_coordinates(names[0], arms[0], (fits.motions or searched.motions)[0])
    words = missing_words(fits.laws, found_by_kind, fits.refused, over)
    return MissingForce(maps, fits.laws, kinds, words, fits.experiment, over)


def as_found(found: FittedLaw) -> WrittenLaw:
    """The form's law with a name of its own, and the values that the search found for its shapes."""

    def own(p: WrittenParameter) -> WrittenParameter:
        return replace(p, scan=(found.values[p.name],)) if p.scan else p

    law = found.form.law
    return replace(law, name=f"law_{law.name}", parameters=tuple(own(p) for p in law.parameters))


@dataclass(frozen=True)
class LawFit:
    """The model with a law, fitted. gain [nats]: of its evidence over that without a law (0: not known yet)."""

    law: WrittenLaw
    problem: Problem
    fitted: Fit
    gain: float = 0.0

    @property
    def refusal(self) -> str:
        """Why it is not proposed: its run leaves all bounds, a number stands at a bound, or its evidence is not known
        or not worth its price; empty where none holds.
        """
        if np.abs(self.fitted.used_residuals).max() >= RAN_AWAY:
            return AWAY
        if held := [name for effect, name in self.fitted.at_bound if effect == self.law.name]:
            return f"its fit ends at a bound of {' and '.join(held)}"
        return "" if GAIN < self.gain < np.inf else "its fit gains too little"


@dataclass(frozen=True)
class LawHypothesis:
    """The model with a law, fitted, and what is said of it."""

    proposed: ProposedLaw
    problem: Problem
    fitted: Fit

    @property
    def effects(self) -> tuple[str, ...]:
        """The law alone."""
        return (self.proposed.law.name,)


@dataclass(frozen=True)
class LawFits:
    """Laws that do well, best first; the motions; the experiment that would split the best law from its rivals; the
    names of the fitted laws that are not proposed, and why.

    The motions have the missing force at the parameters that were fitted with the best law. The base parameters that
    were fitted without a law are biased by the missing force.
    """

    laws: tuple[ProposedLaw, ...]
    motions: tuple[SeenMotion, ...]
    experiment: LawExperiment | None
    refused: dict[str, str]


def _fitted(base: tuple[Problem, Fit], searched: Searched, prepared: list[Prepared], worth: list[FittedLaw]) -> LawFits:
    """The laws fitted one by one in the model's own simulation, best first by their evidence on the fitted frames."""
    problem, fitted = base
    before = midline_error(prepared, problem, fitted, _held_out(prepared))
    laws = [as_found(one) for one in worth]
    own, moved = (_by_name(problem, one.parameters) for one in (fitted, searched.point[1]))
    with using(laws):
        plain = _beside_laws(problem, own)
        bare = fit(plain, fitted.nuisances, tolerance=FIT_TOLERANCE, most=FIT_ROUNDS)
        start = _beside_laws(problem, moved)
        fits = side_by_side(
            [partial(_with_law, start, fitted, found, law) for found, law in zip(worth, laws, strict=True)]
        )
        refused = _away(laws, fits)
        variance = max(1.0, min((2.0 * one.fitted.misfit / one.fitted.count for one in fits), default=1.0))
        nothing = laplace_evidence(plain, bare, variance)
        judged = [replace(one, gain=laplace_evidence(one.problem, one.fitted, variance) - nothing) for one in fits]
        refused |= {one.law.name: one.refusal for one in judged if one.refusal}
        counted = sorted((one for one in judged if not one.refusal), key=lambda one: -one.gain)
        refused |= {one.law.name: f"{MOST} other laws have more evidence" for one in counted[MOST:]}
        closely = _fitted_closely(counted[:MOST], variance)
        refused |= _away([one.law for one in counted[:MOST]], closely)
        judged = [replace(one, gain=laplace_evidence(one.problem, one.fitted, variance) - nothing) for one in closely]
        refused |= {one.law.name: one.refusal for one in judged if one.refusal}
        accepted: list[LawHypothesis] = []
        for one in sorted((one for one in judged if not one.refusal), key=lambda one: -one.gain):
            error = midline_error(prepared, one.problem, one.fitted, _held_out(prepared))
            if error is None or before is None or error < before:
                accepted.append(_hypothesis(one, error, _unexplained_share(bare, one.fitted), variance))
            else:
                refused[one.law.name] = "with it the model errs more on the held-out frames than without a law"
        experiment, motions = None, ()
        if accepted:
            best = accepted[0]
            arms = arms_of(*searched.point)
            motions = tuple(_beside(best, arm, motion) for arm, motion in zip(arms, searched.motions, strict=True))
            rivals = _rivals(accepted)
            proposal = propose_experiment(best, rivals, SERVO_UNDER_LOAD, 0)
            experiment = experiment_of(proposal, tuple(one.proposed for one in (best, *rivals)))
    return LawFits(tuple(one.proposed for one in accepted), motions, experiment, refused)


def _away(laws: list[WrittenLaw], fits: list[LawFit]) -> dict[str, str]:
    """The names of the laws that no fit was found of, because a run left all bounds, and that reason."""
    fitted = [one.law for one in fits]
    return {law.name: AWAY for law in laws if law not in fitted}


def _by_name(problem: Problem, parameters: Array) -> tuple[dict[ParameterName, float], Array]:
    """A whole parameter vector as values by name, and those of the declared numbers."""
    known = {(row.effect, row.parameter.name): float(parameters[row.index]) for row in parameter_rows()}
    return known, parameters[parameters.size - len(problem.declared) :]


def _beside_laws(problem: Problem, values: tuple[dict[ParameterName, float], Array]) -> Problem:
    """The model at these values, with every other law in use absent."""
    parameters, (known, declared) = neutral_parameters(), values
    for name, value in known.items():
        parameters[parameter_index(*name)] = value
    return replace(problem, parameters=np.concatenate([parameters, declared]))


def _deviations(law: WrittenLaw, fitted: Fit, variance: float) -> dict[str, float]:
    """Standard deviations of the law's shapes, if it is true."""
    spread = np.sqrt(variance * np.maximum(np.diag(fitted.covariance), 0.0))
    places = {name: k for k, name in enumerate(fitted.free)}
    return {p.name: float(spread[places[law.name, p.name]]) for p in law.parameters if p.scan}


def _rivals(accepted: list[LawHypothesis]) -> tuple[LawHypothesis, ...]:
    """The laws that follow the held-out frames about as well as the best."""
    best = accepted[0].proposed.held_out_midline_mm
    errors = [(one, one.proposed.held_out_midline_mm) for one in accepted[1:]]
    return tuple(one for one, error in errors if best is not None and error is not None and error <= RIVAL * best)


def _beside(best: LawHypothesis, arm: Arm, motion: SeenMotion) -> SeenMotion:
    """The motion with the force that is missing without the law, at the parameters that were fitted with the law."""
    law, parameters = best.proposed.law, best.problem.known(best.fitted.parameters)[1].copy()
    for p in law.parameters:
        if not p.scan:
            parameters[parameter_index(law.name, p.name)] = 0.0
    force = lacking(arm, parameters, (motion.u, motion.rate, motion.acceleration), motion.instant)
    return replace(motion, force=force)


def _at(p: WrittenParameter, value: float) -> WrittenParameter:
    return replace(p, nominal=value or p.nominal, scan=(value,) if p.scan else ())


def _held_out(prepared: list[Prepared]) -> bool:
    return any(bool((~p.experiment.used).any()) for p in prepared)


def _unexplained_share(before: Fit, after: Fit) -> float:
    """The share of the structured error (without noise) that remains."""

    def structure(one: Fit) -> float:
        return max(2.0 * one.misfit / one.count - 1.0, 0.0)

    return float(np.sqrt(structure(after) / max(structure(before), 1e-12)))


def _with_law(plain: Problem, base: Fit, found: FittedLaw, law: WrittenLaw) -> LawFit:
    """The model with the law added, fitted from what the search found."""
    parameters = plain.parameters.copy()
    for name, value in found.values.items():
        parameters[parameter_index(law.name, name)] = value
    own: tuple[ParameterName, ...] = tuple((law.name, p.name) for p in law.parameters)
    problem = replace(plain, free=(*plain.free, *own), parameters=parameters)
    fitted = fit(problem, base.nuisances, tolerance=FIT_TOLERANCE, most=FIT_ROUNDS)
    return LawFit(law, replace(problem, parameters=fitted.parameters), fitted)


def _fitted_closely(laws: list[LawFit], variance: float) -> list[LawFit]:
    """Laws, best first, fitted to a small tolerance, for a power, a strength and a place trade along a flat valley.

    All get as many curvature coordinates as the recordings hold, if these serve the best: a force at the tip or at one
    place bends an arm more sharply than the coordinates that are seen without it. They serve if they lower its misfit
    by more nats than they add unknowns (Akaike 1974).
    """
    if not laws:
        return []
    best, most = _closer(laws[0]), most_coordinates(laws[0].problem)
    if most > best.problem.arm.order:
        finer = _closer(best, most)
        added = sum(finer.problem.sizes()) - sum(best.problem.sizes())
        if (best.fitted.misfit - finer.fitted.misfit) / variance > added:
            return [finer, *side_by_side([partial(_closer, one, most) for one in laws[1:]])]
    return [best, *side_by_side([partial(_closer, one) for one in laws[1:]])]


def _closer(one: LawFit, order: int | None = None) -> LawFit:
    """A law fitted to a small tolerance, with so many coordinates (None: as it is)."""
    problem, nuisances = one.problem, one.fitted.nuisances
    if order is not None:
        problem, nuisances = with_coordinates(problem, nuisances, order)
    fitted = fit(problem, nuisances, tolerance=CLOSE_TOLERANCE, most=CLOSE_ROUNDS)
    return LawFit(one.law, replace(problem, parameters=fitted.parameters), fitted)


def _hypothesis(one: LawFit, error: float | None, left: float, variance: float) -> LawHypothesis:
    """The law with its fitted values, and what is said of it."""
    parameters = one.fitted.parameters
    values = {p.name: float(parameters[parameter_index(one.law.name, p.name)]) for p in one.law.parameters}
    shown = tuple(_at(p, values[p.name]) for p in one.law.parameters)
    written = replace(one.law, title=title_of(one.law, values), parameters=shown)
    proposed = ProposedLaw(
        written, values, one.gain, error, left, _deviations(one.law, one.fitted, variance),
        one.problem.known(parameters)[0].arm.specimen.length,
    )  # fmt: skip
    return LawHypothesis(proposed, one.problem, one.fitted)
