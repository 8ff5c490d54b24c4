"""From hypotheses to a verdict, by posterior mass alone.

    P(set, known | y) ~ P(set) (1 - ELSE)  int  p(a | laws known)  evidence(set, a) d log a
    P(set, else  | y) ~ P(set)  ELSE       int  p(a | beyond)      evidence(set, a) d log a

a: the share of the acting forces that no law of the set explains (inference.latent_force), flat in its logarithm. Laws
that are known leave a share below LAWS, p ~ exp(-a^2 / 2 LAWS^2); "something else" is every set with a share beyond
that, p ~ 1 - exp(-a^2 / 2 LAWS^2). The verdict is what holds the
most; a group is the smallest family of sets that holds CREDIBLE of what is known.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import comb

import numpy as np

from affine_model.effects import absent_effects, catalogue
from inference.posterior import Hypothesis
from inference.solver_result import RESULTS
from tentacle.diagnosis import Verdict

COMPLETE = (0.4, 0.4, 0.15, 0.05)  # prior of none, one, two and three effects missing: chosen, not measured yet
ELSE = 0.15  # prior of something outside the catalogue; chosen, its sensitivity is not measured yet
LAWS = 0.02  # share of the acting forces that laws of another form leave; chosen, its sensitivity is not measured yet
CREDIBLE = 0.95


@dataclass(frozen=True)
class Decision:
    """The verdict, its effects and its posterior mass; certain: effects of every set that is credible; sets: these with
    their mass; effect -> posterior mass of its being there.
    """

    verdict: Verdict
    effects: tuple[str, ...]
    confidence: float
    certain: tuple[str, ...]
    sets: tuple[tuple[tuple[str, ...], float], ...]
    masses: dict[str, float]
    leading: Hypothesis
    rivals: tuple[Hypothesis, ...]


def log_prior_of_set(count: int) -> float:
    """Log prior of one set of so many effects."""
    return float(np.log(COMPLETE[count] / comb(len(absent_effects()), count)))


def usable(h: Hypothesis) -> bool:
    """Whether a hypothesis may be named: its fit converged, and no strength stands at a bound."""
    strengths = {(name, strength.name) for name in h.effects for strength in catalogue()[name].strengths}
    at_bound = any(name in strengths for name in h.fitted.at_bound)
    return h.fitted.result is not RESULTS.MAX_STEPS and not at_bound


def log_masses(h: Hypothesis) -> tuple[float, float]:
    """Log posterior mass, not normalised, of the set with laws that are known, and with something else beside it."""
    shares, evidence = h.profile()
    width = np.log(shares[1] / shares[0])
    known = -0.5 * (shares / LAWS) ** 2
    anything = np.log(-np.expm1(known))
    known, anything = (p - np.logaddexp.reduce(p) - np.log(width) for p in (known, anything))
    prior = log_prior_of_set(len(h.effects)) + np.log(width)
    within = float(np.logaddexp.reduce(evidence + known)) + prior + np.log(1.0 - ELSE)
    beyond = float(np.logaddexp.reduce(evidence + anything)) + prior + np.log(ELSE)
    return (within if usable(h) else -np.inf), beyond


def decide(hypotheses: list[Hypothesis]) -> Decision:
    """The verdict over hypotheses, one a set of effects, the empty set among them."""
    logs = np.array([log_masses(h) for h in hypotheses])
    mass = np.exp(logs - np.logaddexp.reduce(logs.ravel()))
    order = np.argsort(-mass[:, 0], kind="stable")
    unexplained = float(mass[:, 1].sum())
    empty = next(k for k, h in enumerate(hypotheses) if not h.effects)
    masses: dict[str, float] = {}
    for h, (within, beyond) in zip(hypotheses, mass, strict=True):
        for name in h.effects:
            masses[name] = masses.get(name, 0.0) + float(within + beyond)
    if unexplained >= 0.5:
        leading = hypotheses[int(np.argmax(mass[:, 1]))]
        return Decision("unknown", (), unexplained, (), (), masses, leading, ())
    total, credible = 0.0, []
    for k in order:
        credible.append(int(k))
        total += mass[k, 0]
        if total >= CREDIBLE * (1.0 - unexplained):
            break
    sets = tuple((hypotheses[k].effects, float(mass[k, 0])) for k in credible)
    leading = hypotheses[credible[0]]
    rivals = tuple(hypotheses[k] for k in credible[1:])
    certain = tuple(name for name in leading.effects if all(name in effects for effects, _ in sets))
    if credible[0] == empty or mass[empty, 0] >= 0.5:
        return Decision("nothing_missing", (), float(mass[empty, 0]), (), sets, masses, hypotheses[empty], rivals)
    if certain:
        holding = sum(float(m[0]) for h, m in zip(hypotheses, mass, strict=True) if set(certain) <= set(h.effects))
        return Decision("effect", certain, holding, certain, sets, masses, leading, rivals)
    union = sorted({name for effects, _ in sets for name in effects}, key=lambda name: -masses[name])
    return Decision(
        "group", tuple(union), float(total - mass[empty, 0] * (empty in credible)), (), sets, masses, leading, rivals
    )
