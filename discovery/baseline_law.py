"""Which laws of the material or of the water the baseline's own recordings show: they are the arm's, and act in all.

    gain(law | baseline) / T > odds(1),        T: that of the declared laws' form (discovery.decide)

So a law is taken as the arm's own where it would be named if the baseline were diagnosed by itself. Of several the one
that gains most is taken; then the others are asked again. Nothing but a law that any arm may have is taken: a payload,
a soft spot or a drift of the baseline is none.

A law that was taken must raise the evidence of the baseline's recordings by as much, and stand at no bound. Its form is
known as roughly as that of any law that is added: the model with it leaves a share of FORM of what it explains, and of
the nats that it gains an effect that it resembles may gain FORM_ALIKE^2 (discovery.decide).

Where the declared model is far from the baseline, the first order says nothing. Each law of the material is then fitted
with the base parameters by least squares, from all of its starts, and the best is taken if

    left(law) = sqrt(min |r(law)|^2 / min |r(none)|^2) < MOST_LEFT,     r: residuals of the baseline's recordings
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from affine_model.effects import catalogue
from discovery.decide import FORM, added_coarsening, form_coarsening, odds_against
from discovery.rank import RankedSet
from discovery.side_by_side import side_by_side
from discovery.starts import with_candidates
from inference.base_fit import Setting, rough_base_fit
from inference.fit import Fit
from inference.motion import motion_nats
from inference.posterior import FORCE_SHARES, Hypothesis

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

    def beside(self, without: BaselineError) -> BaselineError:
        """The same where laws were taken, without which it was another: their form is known like that of added laws."""
        share, rest = float(np.hypot(self.share, FORM * without.share)), self.rest + FORM**2 * without.rest
        alike = added_coarsening(self.evidence - without.evidence, self.structured)
        return replace(self, share=share, rest=rest, coarsening=max(self.coarsening, alike))


@dataclass(frozen=True)
class Taken:
    """Laws that a baseline showed, the fit with the last of them where it begins, and the number of coordinates.

    least [nats]: log evidence that the baseline's recordings must have with them. without: the error without any.
    """

    laws: tuple[str, ...]
    warm: Fit
    order: int
    least: float
    without: BaselineError


def least_gain(known: Hypothesis) -> float:
    """Nats that a law must gain in the baseline's recordings to be named there. known: the declared model of these."""
    return form_coarsening(motion_nats(known.problem, known.fitted, known.forces, FORCE_SHARES[0])) * odds_against(1)


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
