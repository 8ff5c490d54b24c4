"""Which laws of the material or of the water the baseline's own recordings show: they are the arm's, and act in all.

    gain(law | baseline) / T > odds(1),        T: that of the declared laws' form (discovery.decide)

So a law is taken as the arm's own where it would be named if the baseline were diagnosed by itself. Of several the one
that gains most is taken; then the others are asked again. Nothing but a law that any arm may have is taken: a payload,
a soft spot or a drift of the baseline is none.

A law that was taken must raise the evidence of the baseline's recordings by as much, and stand at no bound. Its form is
known as roughly as that of any law that is added: the model with it leaves a share of FORM of what it explains, and of
the nats that it gains an effect that it resembles may gain f^2 (discovery.decide).

A baseline that moves little shows little. So a recording may show a law of this kind that acts in the baseline too.
Where the answer is such laws alone, they are taken as the arm's own if all recordings together are likelier with them
in each than with them where they were named:

    evidence(y, y_baseline | law in all) > evidence(y, y_baseline | law in y)

Where the declared model is far from the baseline, the first order says nothing. Each law of the material is then fitted
with the base parameters by least squares, from all of its starts, and the best is taken if

    left(law) = sqrt(min |r(law)|^2 / min |r(none)|^2) < MOST_LEFT,     r: residuals of the baseline's recordings
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from affine_model.curvature import Array
from affine_model.effects import catalogue
from discovery.answer import MOST_EFFECTS
from discovery.decide import (
    DECLARED_FORM,
    FORM,
    MOST_DECLARED_FORM,
    added_coarsening,
    baseline_coarsening,
    bounds_met,
    form_coarsening,
    motion_left,
    odds_against,
)
from discovery.rank import RankedSet, ranking
from discovery.side_by_side import side_by_side
from discovery.starts import with_candidates
from inference.base_fit import Setting, rough_base_fit
from inference.fit import Fit
from inference.motion import motion_shown
from inference.posterior import FORCE_SHARES, Hypothesis, baseline_alone, with_rest
from inference.prepare import CannotTellError
from inference.trajectory import Problem

MATERIAL = ("viscoelasticity", "amplitude_damping", "cubic_stiffness", "dry_friction")  # laws that any arm may have
WATER = ("linear_drag", "skin_drag", "added_mass")
MOST_LEFT = 0.5  # of the error of a baseline that is far from its model: a law that leaves more is not its cause


@dataclass(frozen=True)
class BaselineError:
    """The declared model's own error in the baseline's recordings: share of unknown forces, rest [noise variances], and
    the coarsening of the likelihood with which no absent effect is named there; evidence [nats] of these recordings,
    and structured [nats], by which the residual exceeds noise.
    """

    share: float
    rest: float
    coarsening: float
    evidence: float
    structured: float

    def told(self, base: Hypothesis) -> Hypothesis:
        """The declared model's hypothesis, whose motion is known, with what its baseline says. What a model leaves
        grows with the motion, and is no less than laws leave that hold as well as any.
        """
        judged, there = base.motion.power, base.motion.baseline_power
        rest = judged * max(self.rest / there if there > 0.0 else 0.0, DECLARED_FORM**2)
        return replace(base, baseline_share=self.share, baseline_rest=rest, baseline_coarsening=self.coarsening)

    def beside(self, without: BaselineError) -> BaselineError:
        """The same where laws were taken, without which it was another: their form is known like that of added laws."""
        share, rest = float(np.hypot(self.share, FORM * without.share)), self.rest + FORM**2 * without.rest
        gained, left = self.evidence - without.evidence, self.share / without.share
        alike = added_coarsening(gained, self.structured, left)
        return replace(self, share=share, rest=rest, coarsening=max(self.coarsening, alike))


@dataclass(frozen=True)
class Taken:
    """Laws that are taken as the arm's own, each with the sentence that says why; the fit with them where it begins,
    and the number of coordinates.

    without: the baseline's error without any. least [nats]: log evidence that the baseline's recordings must have with
    them. together [nats]: that all recordings must have (None: it is not asked).
    """

    laws: dict[str, str]
    warm: Fit
    order: int
    without: BaselineError
    least: float = -np.inf
    together: float | None = None

    @property
    def newest(self) -> str:
        """The law that was taken last."""
        return tuple(self.laws)[-1]

    def require_in_baseline(self, known: Hypothesis) -> None:
        """CannotTellError where the laws were taken for the baseline's sake, and its recordings do not ask for them."""
        if self.together is None and not self._served(known, self.least):
            raise CannotTellError(f"{self.newest} is not the arm's own law")

    def require_in_all(self, base: Hypothesis) -> None:
        """CannotTellError where they were taken for the sake of all recordings, and these do not ask for them."""
        if self.together is not None and not self._served(base, self.together):
            raise CannotTellError(f"{' and '.join(self.laws)} does not act in all recordings")

    def _served(self, model: Hypothesis, least: float) -> bool:
        return model.highest() >= least and not bounds_met(model.fitted, self.laws)


@dataclass(frozen=True)
class BaselineShows:
    """What the baseline's recordings show of the model: its error there, and without any law that was taken; the laws
    of which one more may be taken.
    """

    error: BaselineError
    without: BaselineError
    more: tuple[Taken, ...] = ()


def baseline_of(problem: Problem, nuisances: tuple[Array, ...], setting: Setting, taken: Taken | None) -> BaselineShows:
    """What the baseline's recordings show. CannotTellError where the runs leave all bounds there, or where a law that
    was taken for their sake stands at a bound or does not raise their evidence.
    """
    begins = [problem] if taken is None else [problem, replace(problem, parameters=taken.warm.parameters)]
    found = side_by_side([partial(baseline_alone, one, nuisances) for one in begins])
    if not found:
        raise CannotTellError("the runs of the declared model leave all bounds in the baseline's recordings")
    known = with_rest(max(found, key=lambda h: h.highest()))
    if taken is not None:
        taken.require_in_baseline(known)
    evidence, own = known.highest(), {} if taken is None else taken.laws
    ranked, least = ranking(known, MOST_EFFECTS).sets, least_gain(known)
    coarsening = baseline_coarsening((len(one.names), one.evidence) for one in ranked)
    error = BaselineError(known.share, max(known.rest, 0.0), coarsening, evidence, known.structured)
    without = error if taken is None else taken.without
    shows = BaselineShows(error if taken is None else error.beside(without), without)
    if len(own) == MOST_EFFECTS or (taken is not None and taken.together is not None):
        return shows
    if known.share > MOST_DECLARED_FORM:
        best = law_that_leaves_least(setting)
        begun = [] if best is None else [best]
    else:
        begun = [(one.names[0], begun_with(known.fitted, one)) for one in laws_shown(ranked, least)]
    more = []
    for law, warm in begun:
        laws = own | {law: f"The baseline's own recordings show {law}."}
        more.append(Taken(laws, warm, setting.order, without, evidence + least))
    return replace(shows, more=tuple(more))


def least_gain(known: Hypothesis, with_law: Hypothesis | None = None) -> float:
    """Nats that a law must gain in the baseline's recordings to be named there.

    known: the fitted declared model of these recordings. with_law: the fitted model that has the law, with its rest.
    Without it, the law counts as one that leaves much.
    """
    motion = motion_shown(known.problem, known.fitted, known.forces, FORCE_SHARES[0])
    left = float("inf") if with_law is None else motion_left(with_law, motion)
    return form_coarsening(motion.nats, left) * odds_against(1)


def laws_shown(ranked: Iterable[RankedSet], least: float) -> list[RankedSet]:
    """The laws of an arm that gain more than so many nats to first order, the one that gains most first."""
    single = [one for one in ranked if len(one.names) == 1 and one.names[0] in (*MATERIAL, *WATER)]
    return sorted((one for one in single if one.evidence > least), key=lambda one: -one.evidence)


def begun_with(fitted: Fit, shown: RankedSet) -> Fit:
    """A fit of the baseline with one more law where the linear estimate about it puts that."""
    chosen = list(zip(shown.candidates, shown.strengths, strict=True))
    return replace(fitted, parameters=with_candidates(fitted.parameters, chosen, 1.0))


def law_that_leaves_least(setting: Setting) -> tuple[str, Fit] | None:
    """The law of the material that leaves least of the baseline's error, and the fit with it; None where it leaves more
    than MOST_LEFT.
    """
    alone = tuple(replace(e, varies=(), complete=False) for e in setting.experiments if e.complete)
    own = setting.declaration.specimen.laws
    setting = replace(setting, experiments=alone)
    sets = [own, *((*own, law) for law in MATERIAL if law not in own)]
    declared, *others = side_by_side([partial(_fitted_with, setting, one) for one in sets])
    best = min(others, key=lambda one: one[1].misfit, default=declared)
    if declared[0] != own or best[1].misfit > MOST_LEFT**2 * declared[1].misfit:
        return None
    return best[0][-1], best[1]


def _fitted_with(setting: Setting, laws: tuple[str, ...]) -> tuple[tuple[str, ...], Fit]:
    """These laws, and the declared model's fit with them by least squares, with two coordinates."""
    declaration = setting.declaration
    relaxes = any(catalogue()[law].relaxation_time is not None for law in laws)
    experiments = tuple(replace(e, declared=e.declared | set(laws), remembers=relaxes) for e in setting.experiments)
    with_laws = replace(declaration, specimen=replace(declaration.specimen, laws=laws))
    return laws, rough_base_fit(replace(setting, declaration=with_laws, experiments=experiments), 2)[1]
