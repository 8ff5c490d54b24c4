"""Whether an arm's sections shear, as those of a solid do (affine_model.shear): the declared model with and without.

    gain = log evidence(y_0 | f = 1) - log evidence(y_0 | f = 0) > T odds(1),       f: specimen.shear_compliance

y_0: the baseline's recordings, or all where there is no baseline; T: that of the declared laws' form, where the model
with shear leaves what it does (discovery.decide). So shear is taken as a law of the arm's own is. A baseline must then
need no more than MOST_LEFT of the unknown forces, or DECLARED_FORM of the acting ones: where it lacks more than shear,
its laws' form gains as much. Shear has no strength to be fitted: the moduli of an incompressible solid have one ratio.
Simulated beams mostly have none, so that it is not taken for granted. Without a baseline an effect may look like shear:
then both models are searched, and the answer is that of

    max over f of  log evidence(y | set, f) / T + log P(set) - f odds(1),       T: that of the likeliest of all sets
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from functools import partial

from affine_model.effects import catalogue
from affine_model.shear import shear_of
from discovery.baseline_law import MOST_LEFT, least_gain
from discovery.decide import DECLARED_FORM, odds_against
from discovery.declared_fit import DeclaredFit, fit_declared
from discovery.given import Deciding
from discovery.side_by_side import side_by_side
from inference.declared_arm import SHEAR
from inference.posterior import Hypothesis, baseline_alone, declared_model, with_rest
from inference.prepare import CannotTellError
from inference.trajectory import Problem
from tentacle.errors import InputError
from tentacle.progress import Stage
from tentacle.recording import Declaration

SOLID = 1.0  # specimen.shear_compliance of an incompressible solid


def sheared_fit(plain: DeclaredFit, deciding: Deciding, progress: Stage) -> DeclaredFit | None:
    """The fit with sections that shear, if the recordings show it; None where they do not, where something is declared
    about it, or where the arm is too thick for it.
    """
    problem = _with_shear(plain.fine)
    if problem is None or any(declares_shear(one.declaration) for one in plain.given.all):
        return None
    alone = baseline_alone if plain.given.baseline else declared_model
    found = side_by_side([partial(alone, one, plain.fitted.nuisances) for one in (plain.fine, problem)])
    if len(found) < 2 or _gain(*found) < odds_against(1) or _gain(*found) < least_gain(found[0], with_rest(found[1])):
        return None
    if plain.given.baseline and found[1].share > max(MOST_LEFT * found[0].share, DECLARED_FORM):
        return None
    where = "The baseline is" if plain.given.baseline else "The recordings are"
    words = f"{where} likelier, by {_gain(*found):.0f} nats, if the arm's sections shear as those of a solid do."
    with suppress(CannotTellError):
        return fit_declared(plain.given.with_shear(SOLID, words), deciding, progress)
    return None


def declares_shear(declaration: Declaration) -> bool:
    """Whether a recording says how much its arm's sections shear, as a number or an uncertain one."""
    stated = any(number.field == SHEAR for number in declaration.uncertain)
    return stated or declaration.specimen.shear_compliance > 0.0


def _with_shear(problem: Problem) -> Problem | None:
    """The problem of an arm whose sections shear; None where it is too thick for the coordinates of a search."""
    specimen = replace(problem.arm.specimen, shear_compliance=SOLID)
    try:
        shear_of(specimen, problem.arm.order + max(effect.extra_order for effect in catalogue().values()))
    except InputError:
        return None
    return replace(problem, arm=replace(problem.arm, specimen=specimen))


def _gain(plain: Hypothesis, sheared: Hypothesis) -> float:
    return sheared.highest() - plain.highest()
