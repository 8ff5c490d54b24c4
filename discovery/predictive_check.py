"""The predictive check: effects that are named must explain the frames on which nothing was chosen.

    left = (after^2 - floor^2) / (before^2 - floor^2)
    p(else | judged) = p(else) / (p(else) + (1 - p(else)) k),    k = exp(-left / 2 (FORM^2 + b^2 / r_0^2))

before, after: rms errors of the declared model and of the answer's on the judged frames, both with all coordinates and
without unknown forces. k is the decision's own (discovery.decide): laws whose form is known to FORM leave so much, and
b^2 is what the declared model leaves in its baseline, r_0^2 in the recordings. An answer is withdrawn if it leaves more
than MOST_UNPREDICTED, and something else is then the likelier; or if it errs more than the paper's model.

Sources: Dawid 1984 (a model is judged by its predictions); Gelman, Meng and Stern 1996 (posterior predictive checks).
"""

from __future__ import annotations

import numpy as np

from discovery.decide import FORM, Missing, PosteriorDecision

MOST_UNPREDICTED = 0.5  # more is left than explained; its sensitivity: docs/loop_trials.md


def unpredicted(before: float | None, after: float | None, floor: float | None) -> float:
    """The share of the declared model's squared error beyond the floor that is left; 0 where there is no such error, so
    that nothing can be told.
    """
    if before is None or after is None or before <= (floor or 0.0):
        return 0.0
    noise = (floor or 0.0) ** 2
    return max(after**2 - noise, 0.0) / (before**2 - noise)


def mass_of_else(decision: PosteriorDecision, missing: Missing, left: float) -> float:
    """The posterior mass of something else, given also that so much is left of the judged frames' error."""
    form = FORM**2 + missing.declared_rest / max(missing.rest, 1e-300)
    known = (1.0 - decision.unexplained) * float(np.exp(-0.5 * left / form))
    return decision.unexplained / max(decision.unexplained + known, 1e-300)


def is_withdrawn(decision: PosteriorDecision, missing: Missing, left: float, *, worse: bool) -> bool:
    """Whether effects were named that do not predict the judged frames. worse: they err more than the paper's model."""
    named = decision.verdict in ("effect", "group")
    return named and (worse or (left > MOST_UNPREDICTED and mass_of_else(decision, missing, left) > 0.5))


def predictive_words(effects: tuple[str, ...], left: float, *, withdrawn: bool) -> list[str]:
    """A sentence where the best model's effects are withdrawn, or where it errs more than the declared model."""
    names = " + ".join(effects)
    if withdrawn and left > MOST_UNPREDICTED:
        return [
            f"{names} would be named, but on the judged frames {100.0 * left:.0f} % of the missing motion's power is "
            "left: they do not predict it."
        ]
    if withdrawn:
        return [f"With {names} the model predicts the judged frames worse than without: nothing is named."]
    return ["On the judged frames the best model found errs more than the declared model."] if left > 1.0 else []
