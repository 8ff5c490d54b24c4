"""Detection limits: the smallest strength of each absent effect that these recordings would show.

    limit = s (sqrt(2 (T log prior odds + price of a free strength)) + 1.645)

s is the standard deviation of the strength beside the chosen model. T is the factor by which the decision coarsens the
likelihood, and by which the set-up's prior variance is divided (discovery.decide). An estimate p is named if
(p^2 / 2 s^2 - price of a free strength) / T exceeds the log prior odds. A true strength 1.645 s above that is named in
95 of 100 recordings.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from discovery.decide import log_prior_of_set
from inference.posterior import Hypothesis, filters_at
from inference.score import responses, score
from inference.whitened_fit import whitened_fit
from tentacle.diagnosis import Limit

ONE_SIDED_95 = 1.645


def detection_limits(chosen: Hypothesis, temperature: float) -> dict[str, dict[str, Limit]]:
    """Effect -> parameter -> smallest strength named, beside the chosen model; temperature: T."""
    count = len(chosen.effects)
    if count >= 3:
        return {}
    odds = temperature * (log_prior_of_set(count) - log_prior_of_set(count + 1))
    limits: dict[str, dict[str, Limit]] = {}
    known = responses(chosen.problem, chosen.fitted)
    filters = filters_at(chosen.forces, chosen.fitted_at, temperature)
    for candidate in score(whitened_fit(chosen.problem, chosen.fitted, filters), known):
        if candidate.effect.name in chosen.effects:
            continue
        for strength, column in zip(candidate.effect.strengths, candidate.sensitivity.T, strict=True):
            size = float(np.linalg.norm(column))
            deviation = 1.0 / size if size > 0.0 else np.inf
            price = np.log(np.pi * strength.nominal / (2.0 * np.sqrt(2.0 * np.pi) * deviation)) if size > 0.0 else 0.0
            needed = np.sqrt(2.0 * max(odds + price, 0.0)) + ONE_SIDED_95
            value = float(needed * deviation)
            if value < max(abs(bound) for bound in strength.bounds):
                limits.setdefault(candidate.effect.name, {})[strength.name] = Limit(value, strength.unit)
    return limits


def of_unnamed(limits: Mapping[str, dict[str, Limit]], named: Collection[str]) -> dict[str, dict[str, Limit]]:
    """The limits of the effects that the answer does not name, alone or in a group: what was found needs none."""
    return {effect: strengths for effect, strengths in limits.items() if effect not in named}
