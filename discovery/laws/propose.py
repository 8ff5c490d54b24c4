"""Proposals: the search's best laws, each fitted as an effect of the model through the compiled kernel, and judged on
frames that neither search nor fit used.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from affine_model.arm import Arm, neutral_parameters, parameter_index, parameter_rows
from affine_model.curvature import Array
from discovery.answer import SERVO_UNDER_LOAD, proposal_words
from discovery.laws.along import force_map
from discovery.laws.operating_point import Searched, arms_of, settled_search, sought_at
from discovery.laws.search import FittedLaw
from discovery.next_experiment import Proposal, propose_experiment
from inference.compare import midline_error
from inference.missing_force import SeenMotion, lacking
from inference.prepare import Prepared
from inference.prior import laplace_evidence
from inference.trajectory import Fit, ParameterName, Problem, fit
from tentacle.io.waveform_file import waveform_table
from tentacle.law.in_use import using
from tentacle.law.written_law import WrittenLaw, WrittenParameter
from tentacle.proposed_law import MissingForce, ProposedLaw

FITTED, MOST = 8, 5  # laws that are fitted, and that are shown
EXPLAINS = 0.9  # largest share of the missing force's answer that a law may leave and still be fitted
RIVAL = 1.1  # of the best law's error on held-out frames: a law within it is its rival
FIT_ROUNDS, FIT_TOLERANCE = 25, 1e-4
BETTER = 1.0  # of the base's error on held-out frames: what a proposal must reach
LEAST_FORCE = 0.25  # noise deviations rms of the missing force's answer, below which nothing is sought
GAIN = 20.0  # nats beyond its price that a law must bring
LAW_KINDS = {
    "the speed": ("drag_", "skin_", "one_way", "tip_drag"), "the speed near a place": ("patch_",),
    "the place of the tip": ("attraction", "tether", "tip_spring", "stop_"), 
    "the place of every section": ("jet", "line_spring"),
    "time": ("vortex", "beat_x", "tip_beat"), "nothing (a steady force)": ("tip_push",),
    "the curvature": ("bending", "one_sided"), "the curvature before": ("late",),
}  # fmt: skip


def propose_laws(
    base: tuple[Problem, Fit], prepared: list[Prepared], progress: Callable[[str], None] = lambda _: None
) -> MissingForce:
    """The missing force of a fitted model, and laws for it; empty where every recording is complete."""
    progress("smoothing the missing force")
    motions, sought = sought_at(base)
    if not motions:
        return MissingForce()
    names = [e.name for e in base[0].experiments if not e.complete]
    arms = arms_of(*base)
    maps = tuple(force_map(*one) for one in zip(names, arms, motions, strict=True))
    if sought.size < LEAST_FORCE:
        return MissingForce(maps, (), (), ("The missing force does not stand out of the noise: no law is proposed.",))
    progress("searching laws for it")
    searched = settled_search(base, motions)
    found = searched.laws
    maps = tuple(force_map(*one) for one in zip(names, arms, searched.motions, strict=True))
    kinds = tuple((kind, min(one.unexplained for one in found if one.form.law.name.startswith(starts)))
                  for kind, starts in LAW_KINDS.items()
                  if any(one.form.law.name.startswith(starts) for one in found))  # fmt: skip
    worth = [one for one in found if one.evidence > GAIN and one.unexplained < EXPLAINS][:FITTED]
    if not worth:
        words = ("No law of the grammar explains the missing force: the best leaves "
                 f"{100.0 * min(one.unexplained for one in found):.0f} % of its effect.",)  # fmt: skip
        return MissingForce(maps, (), kinds, words)
    progress("fitting the best laws")
    fits = _fitted(base, searched, prepared, worth)
    if fits.motions:
        maps = tuple(force_map(*one) for one in zip(names, arms, fits.motions, strict=True))
    words = _words(fits.laws, kinds)
    if fits.next_motion is not None:
        words = (*words, proposal_words(fits.next_motion))
    return MissingForce(maps, fits.laws, kinds, words, fits.next_motion and waveform_table(fits.next_motion.waveform))


def as_found(found: FittedLaw) -> WrittenLaw:
    """The form's law with a name of its own, and the values that the search found for its shapes."""

    def own(p: WrittenParameter) -> WrittenParameter:
        return replace(p, scan=(found.values[p.name],)) if p.scan else p

    law = found.form.law
    return replace(law, name=f"law_{law.name}", parameters=tuple(own(p) for p in law.parameters))


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
    """Laws that do well, best first; the motions; the base motion that would split the best law from its rivals.

    The motions have the missing force at the parameters that were fitted with the best law. The base parameters that
    were fitted without a law are biased by the missing force.
    """

    laws: tuple[ProposedLaw, ...]
    motions: tuple[SeenMotion, ...]
    next_motion: Proposal | None


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
        fits = [(found, law, *_with_law(start, fitted, found, law)) for found, law in zip(worth, laws, strict=True)]
        variance = max(1.0, min(2.0 * again.misfit / again.count for *_, again in fits))
        nothing = laplace_evidence(plain, bare, variance)
        accepted: list[LawHypothesis] = []
        for _, law, problem_with, again in fits:
            error = midline_error(prepared, problem_with, again, _held_out(prepared))
            gain = laplace_evidence(problem_with, again, variance) - nothing
            if gain < GAIN or (error is not None and before is not None and error > BETTER * before):
                continue
            values = {p.name: float(again.parameters[parameter_index(law.name, p.name)]) for p in law.parameters}
            written = replace(law, parameters=tuple(_at(p, values[p.name]) for p in law.parameters))
            proposed = ProposedLaw(
                written, values, gain, error, _unexplained_share(bare, again), _deviations(law, again, variance),
                problem.known(fitted.parameters)[0].arm.specimen.length,
            )  # fmt: skip
            accepted.append(LawHypothesis(proposed, problem_with, again))
        accepted = sorted(accepted, key=lambda one: -one.proposed.evidence)[:MOST]
        next_motion, motions = None, ()
        if accepted:
            best = accepted[0]
            arms = arms_of(best.problem, best.fitted)
            motions = tuple(_beside(best, arm, motion) for arm, motion in zip(arms, searched.motions, strict=True))
            next_motion = propose_experiment(best, _rivals(accepted), SERVO_UNDER_LOAD, 0)
    return LawFits(tuple(one.proposed for one in accepted), motions, next_motion)


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
    return (
        replace(p, nominal=value or p.nominal, scan=(value,)) if p.scan else replace(p, nominal=abs(value) or p.nominal)
    )


def _held_out(prepared: list[Prepared]) -> bool:
    return any(bool((~p.experiment.used).any()) for p in prepared)


def _unexplained_share(before: Fit, after: Fit) -> float:
    """The share of the structured error (without noise) that remains."""

    def structure(one: Fit) -> float:
        return max(2.0 * one.misfit / one.count - 1.0, 0.0)

    return float(np.sqrt(structure(after) / max(structure(before), 1e-12)))


def _with_law(plain: Problem, base: Fit, found: FittedLaw, law: WrittenLaw) -> tuple[Problem, Fit]:
    """The model with the law added, fitted from what the search found."""
    parameters = plain.parameters.copy()
    for name, value in found.values.items():
        parameters[parameter_index(law.name, name)] = value
    own: tuple[ParameterName, ...] = tuple((law.name, p.name) for p in law.parameters)
    problem = replace(plain, free=(*plain.free, *own), parameters=parameters)
    fitted = fit(problem, base.nuisances, tolerance=FIT_TOLERANCE, most=FIT_ROUNDS)
    return replace(problem, parameters=fitted.parameters), fitted


def _words(laws: tuple[ProposedLaw, ...], kinds: tuple[tuple[str, float], ...]) -> tuple[str, ...]:
    """What the search found, each with its evidence."""
    if not laws:
        return ("No law of the grammar predicts the held-out frames: none is proposed.",)
    best = laws[0]
    words = [
        f"Proposed law: {best.words}. It leaves {100.0 * best.unexplained:.0f} % of the structured error; "
        f"the error on held-out frames is {best.held_out_midline_mm:.2f} mm."
    ]
    if len(laws) > 1:
        words.append(f"The next law, {laws[1].words}, is {laws[0].evidence - laws[1].evidence:.0f} nats behind.")
    if region := best.region_words:
        words.append(region)
    shares = ", ".join(f"{kind} {100.0 * left:.0f} %" for kind, left in sorted(kinds, key=lambda row: row[1]))
    words.append(f"Share of the missing force's effect that the best law of each kind leaves: {shares}.")
    return tuple(words)
