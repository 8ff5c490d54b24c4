"""Which laws of the material or of the water the baseline's own recordings show: they are the arm's, and act in all.

    gain(law | baseline) / T > odds(1),        T: that of the declared laws' form (discovery.decide)

So a law is taken as the arm's own where it would be named if the baseline were diagnosed by itself. Of several the one
that gains most is taken; then the others are asked again. Nothing but a law that any arm may have is taken: a payload,
a soft spot or a drift of the baseline is none.

Where the declared model is far from the baseline, the first order says nothing. Each law of the material is then fitted
with the base parameters by least squares, from all of its starts, and the best is taken if

    left(law) = sqrt(min |r(law)|^2 / min |r(none)|^2) < MOST_LEFT,     r: residuals of the baseline's recordings
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import partial

from affine_model.effects import catalogue
from discovery.decide import form_coarsening, odds_against
from discovery.rank import RankedSet
from discovery.side_by_side import side_by_side
from discovery.starts import with_candidates
from inference.base_fit import Setting, rough_base_fit
from inference.fit import Fit

MATERIAL = ("viscoelasticity", "amplitude_damping", "cubic_stiffness", "dry_friction")  # laws that any arm may have
WATER = ("linear_drag", "skin_drag", "added_mass")
MOST_TAKEN = 3  # laws of one arm
MOST_LEFT = 0.5  # of the error of a baseline that is far from its model: a law that leaves more is not its cause


@dataclass(frozen=True)
class Taken:
    """Laws that a baseline showed, the fit with the last of them where it begins, and the number of coordinates."""

    laws: tuple[str, ...]
    warm: Fit
    order: int


def laws_shown(ranked: Iterable[RankedSet], motion: float) -> list[RankedSet]:
    """The laws of an arm that would be named in the baseline's recordings, the one that gains most first. motion
    [nats]: of these recordings (inference.motion).
    """
    single = [one for one in ranked if len(one.names) == 1 and one.names[0] in (*MATERIAL, *WATER)]
    least = form_coarsening(motion) * odds_against(1)
    return sorted((one for one in single if one.evidence > least), key=lambda one: -one.evidence)


def taken_with(laws: tuple[str, ...], shown: RankedSet, fitted: Fit, order: int) -> Taken:
    """One more law beside those that were taken, where the linear estimate puts it about a fit of the baseline."""
    parameters = with_candidates(fitted.parameters, list(zip(shown.candidates, shown.strengths, strict=True)), 1.0)
    return Taken((*laws, *shown.names), replace(fitted, parameters=parameters), order)


def law_that_leaves_least(setting: Setting, laws: tuple[str, ...]) -> tuple[Taken, ...]:
    """The law of the material that leaves least of the baseline's error, beside those that were taken; none where it
    leaves more than MOST_LEFT.
    """
    alone = tuple(replace(e, varies=(), complete=False) for e in setting.experiments if e.complete)
    own = setting.declaration.specimen.laws
    setting = replace(setting, experiments=alone)
    sets = [own, *((*own, law) for law in MATERIAL if law not in own)]
    declared, *others = side_by_side([partial(_fitted_with, setting, one) for one in sets])
    best = min(others, key=lambda one: one[1].misfit, default=declared)
    if declared[0] != own or best[1].misfit > MOST_LEFT**2 * declared[1].misfit:
        return ()
    return (Taken((*laws, best[0][-1]), best[1], setting.order),)


def _fitted_with(setting: Setting, laws: tuple[str, ...]) -> tuple[tuple[str, ...], Fit]:
    """These laws, and the declared model's fit with them by least squares, with two coordinates."""
    declaration = setting.declaration
    relaxes = any(catalogue()[law].relaxation_time is not None for law in laws)
    experiments = tuple(replace(e, declared=e.declared | set(laws), remembers=relaxes) for e in setting.experiments)
    with_laws = replace(declaration, specimen=replace(declaration.specimen, laws=laws))
    return laws, rough_base_fit(replace(setting, declaration=with_laws, experiments=experiments), 2)[1]
