"""From the search's outcome to a verdict: nothing missing, an effect, a group, or unknown; and how sure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from discovery.hypothesis import Hypothesis
from discovery.search import MOST_EFFECTS, Search
from tentacle.diagnosis import Verdict

NEARLY = 0.12  # of the first misfit: what an effect may leave and still be named, if that rest is under a noise sigma
DOMINANT = 0.07  # the same, whatever the noise: measured arms are never followed down to a motion capture's microns
AGREED = 0.2  # where what all rivals agree on leaves no more than this share, the rest of their difference is a detail


@dataclass(frozen=True)
class Decision:
    """The verdict with its effects (third_curvature apart) and the confidence in it."""

    verdict: Verdict
    effects: tuple[str, ...]
    confidence: float
    words: tuple[str, ...]


def structure_share(search: Search, reached: Hypothesis) -> float:
    """How much of the structured error (noise taken off) a model leaves, 0 .. 1, on held-out frames where there are
    any.
    """

    def structure(h: Hypothesis) -> float:
        return h.judged.structure if h.judged.gates else h.train.structure

    before = structure(search.base)
    return structure(reached) / before if before > 0 else 0.0


def probabilities(search: Search) -> dict[str, float]:
    """Weights of the single-effect models among themselves, tempered by the looseness; they rank, they are no
    calibrated odds.
    """
    pool = list(search.single)
    if not pool:
        return {}
    evidence = np.array([h.evidence for h in pool]) / (2.0 * search.looseness)
    weights = np.exp(evidence - evidence.max())
    weights /= weights.sum()
    return {h.effects[0]: float(weight) for h, weight in zip(pool, weights, strict=True)}


def decide(search: Search) -> Decision:
    """The verdict. An explanation counts where the gates pass with it, or where what it leaves is small beside what
    it explains.
    """
    base, chosen = search.base, search.chosen
    passed = chosen.train.passed and (chosen.judged.passed or not chosen.judged.gates)
    if not chosen.effects and passed:
        margin = max(gate.statistic / gate.threshold for gate in (*base.train.gates, *base.judged.gates))
        return Decision("nothing_missing", (), float(np.clip(1.0 - 0.5 * max(margin, 0.0) ** 8, 0.5, 0.98)), ())
    share = structure_share(search, chosen)
    few = len(chosen.effects) < MOST_EFFECTS or _against_baseline(chosen)  # three that do not suffice explain nothing
    explained = bool(chosen.effects) and (passed or (few and share < _tolerated(chosen)))
    if not explained:
        words = ["No effect of the catalogue, nor a combination of up to three, brings the residual down to the noise."]
        if chosen.effects:
            words.append(
                f"The best partial account is {' + '.join(chosen.effects)}: "
                f"it leaves {100 * share:.0f} % of the structured error."
            )
        return Decision("unknown", (), float(np.clip(1.0 - np.exp(-8.0 * share), 0.5, 0.95)), tuple(words))
    words = []
    if not passed:
        words.append(
            f"{' + '.join(chosen.effects)} explains all but {100 * share:.0f} % of the structured error; "
            "the rest is above the noise and has no name here."
        )
    if not search.rivals:
        return Decision("effect", chosen.effects, _confidence(search, passed, share), tuple(words))
    alternatives = sorted({name for h in (chosen, *search.rivals) for name in h.effects} - set(search.core.effects))
    agreed = search.core.effects
    if agreed and structure_share(search, search.core) < AGREED:
        words.append(
            f"Beyond {' + '.join(agreed)}, a smaller part is shared by {', '.join(alternatives)}: "
            "these are not to be told apart here."
        )
        return Decision("effect", agreed, _confidence(search, passed, share), tuple(words))
    words.append("These data do not split " + ", ".join(alternatives) + ".")
    return Decision("group", (*alternatives, *agreed), 0.9 if passed else 0.7, tuple(words))


def _tolerated(chosen: Hypothesis) -> float:
    """The share of the first error that may stay unexplained under a named effect."""
    rest = max(chosen.train.structure, chosen.judged.structure)
    return NEARLY if _against_baseline(chosen) or rest < 1.0 else DOMINANT


def _against_baseline(chosen: Hypothesis) -> bool:
    return any(experiment.correlation > 1.0 for experiment in chosen.problem.experiments)


def _confidence(search: Search, passed: bool, share: float) -> float:
    """Distance to the next best explanation held against what was left over."""
    sure = 1.0 - 0.5 * float(np.exp(-max(search.margin, 0.0) / 10.0))
    return float(np.clip(sure * (1.0 if passed else 1.0 - 2.0 * share), 0.05, 0.98))
