"""Proposed laws of the grammar with made-up numbers, for tests of what is said of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from discovery.laws.grammar import Scale, forms
from discovery.laws.search import FittedLaw
from tentacle.proposed_law import ForceOver, ProposedLaw

FORMS = {form.law.name: form for form in forms(Scale(0.14, True, 26.0))}


def proposed(name: str, left: float, evidence: float = 5000.0, spread: float = 0.0001) -> ProposedLaw:
    """A law of that form at its nominal values, which leaves that share; its shapes have that deviation."""
    law = replace(FORMS[name].law, name=f"law_{name}")
    deviations = {p.name: spread for p in law.parameters if p.scan}
    return ProposedLaw(law, {p.name: p.nominal for p in law.parameters}, evidence, 0.27, left, deviations, 0.14)


def searched(name: str, left: float) -> FittedLaw:
    """The same as the search finds it."""
    return FittedLaw(FORMS[name], {}, {}, 100.0, 10.0, left, {})


def over(coordinate: str, predicted: float, frequency: float | None = None) -> ForceOver:
    """A force at s = .6 that a curve over that coordinate predicts so well."""
    none = np.zeros(3)
    return ForceOver("one", 0.6, 0.99, coordinate, "m", none, none, none, predicted, frequency)
