"""Sentences about the uncertain declared numbers and the declared laws: what the data say of each."""

from __future__ import annotations

from collections.abc import Mapping

from inference.declared_arm import names_of
from inference.estimates import declared_deviations, estimates
from inference.fit import Fit
from inference.trajectory import Problem
from tentacle.declared import Uncertain
from tentacle.model import Estimate
from tentacle.rounding import rounded

# Standard deviations of the declaration: one honest declaration in 400 is farther from its number
FAR_FROM_DECLARED = 3.0
SILENT = 0.9  # of the declared spread: if the fit leaves more than this share, the data say nothing about the number
IMITATED = (
    "These numbers are those of the best model found, which only imitates what is missing: they may be wrong by more "
    "than is stated."
)
LIKELY = 1.96  # of a normal number that is cut at its most likely value, 95 % lies within so many standard deviations


def declared_words(
    problem: Problem,
    fitted: Fit,
    inflation: float = 1.0,
    taken: Mapping[str, str] | None = None,
    *,
    imitates: bool = False,
) -> list[str]:
    """A sentence for each law of the arm's own, with its parameters and their 95 % intervals, and for each uncertain
    number: what was declared, what the data say, and whether the two agree. inflation: see inference.estimates. taken:
    laws that were not declared, and the sentence that says why they are counted as the arm's own. imitates: the model
    only imitates something unknown, which is said too where a number was found.
    """
    table, why = estimates(problem, fitted, inflation), taken or {}
    deviations = declared_deviations(problem, fitted, inflation)
    words = [_law_sentence(name, table[name], why.get(name)) for name in problem.arm.specimen.laws if name in table]
    for name, number in zip(names_of(problem.declared), problem.declared, strict=True):
        if name not in fitted.free:
            continue
        value = float(fitted.values[fitted.free.index(name)])
        words.append(_sentence(number, value, deviations[number.name]))
    return [*words, IMITATED] if imitates and any("the data say" in one for one in words) else words


def _law_sentence(name: str, fitted: Mapping[str, Estimate], why: str | None) -> str:
    values = ", ".join(f"{key} = {e.with_unit} ({e.interval_words})" for key, e in fitted.items())
    if why is not None:
        return f"{why} It is taken as the arm's own law, in all recordings: {values}."
    return f"The declared law {name} acts in all recordings: {values}."


def _sentence(number: Uncertain, value: float, sd: float) -> str:
    stated = f"{number.low:.4g} to {number.high:.4g}"
    if number.sd is not None:
        stated = f"{number.value:.4g} +- {rounded(number.sd, number.sd)}"
    low, high = number.bounds
    margin = 1e-3 * (high - low)
    at_limit = not low + margin < value < high - margin
    if at_limit and (number.sd is None or abs(value - number.value) > margin):
        return f"{number.name} is declared as {stated}; the fit ends at its limit, {value:.4g}: check the declaration."
    if sd > SILENT * number.spread:
        return f"{number.name} is declared as {stated}; these data say nothing about it."
    if at_limit:  # it was declared there, as a clamp that does not give
        reach = f"at most {rounded(value + LIKELY * sd, sd)}"
        if value > low + margin:
            reach = f"at least {rounded(value - LIKELY * sd, sd)}"
        return f"{number.name} is declared as {stated}; the data say {reach} (95 %)."
    found = f"{number.name} is declared as {stated}; the data say {rounded(value, sd)} +- {rounded(sd, sd)}"
    if number.sd is not None and abs(value - number.value) > FAR_FROM_DECLARED * number.sd:
        return f"{found}, {abs(value - number.value) / number.sd:.1f} declared deviations away: check the declaration."
    return f"{found}."
