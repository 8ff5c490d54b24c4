"""From hypotheses to a verdict, by posterior mass alone.

    P(set, known | y) ~ P(set) (1 - ELSE)  int  k(a, r)      evidence(set, a)^(1/T) d log a
    P(set, else  | y) ~ P(set)  ELSE       int (1 - k(a, r)) evidence(set, a)^(1/T) d log a
    k = exp(-a^2 / 2 s^2 - r^2 / 2 FORM^2),  s^2 = DECLARED_FORM^2 + (FORM a_0)^2,  T = 1 + FORM_ALIKE^2 G

a: the share of the acting forces that no law of the set explains (inference.latent_force), flat in its logarithm. The
declared laws leave a share of DECLARED_FORM. Laws that are added are known no better than to FORM: they leave that
share of the force a_0 that is missing without them, and of the error: r^2 is the rest that the set's model alone leaves
of the data, over the rest without it. "Something else" is every set with more left than that.
Models whose form is known so far only cannot be told apart by less than what their form costs: of the G nats that the
best set gains, FORM_ALIKE^2 G may fall to any effect that resembles the error of form. The likelihood is therefore
coarsened by T (Miller and Dunson 2019, Robust Bayesian inference via coarsening); where little is gained, T is 1.
The verdict is what holds the most; a group is the smallest family of sets that holds CREDIBLE of what is known.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import comb

import numpy as np

from affine_model.effects import absent_effects, catalogue
from inference.posterior import Hypothesis
from inference.solver_result import RESULTS
from tentacle.diagnosis import Verdict

COMPLETE = (0.4, 0.4, 0.15, 0.05)  # prior of none, one, two and three effects missing: chosen, not measured yet
ELSE = 0.15  # prior of something outside the catalogue; chosen, its sensitivity is not measured yet
DECLARED_FORM = 0.003  # share of the acting forces that the declared laws leave
FORM = 0.3  # share of what an added law explains that its true form may differ by
FORM_ALIKE = 0.15  # share of it that resembles another effect
CREDIBLE = 0.95


@dataclass(frozen=True)
class PosteriorDecision:
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


@dataclass(frozen=True)
class Missing:
    """What the declared model leaves: share of the acting forces, rest of the data beyond noise [noise variances], and
    the best log evidence [nats] with it and with any set.
    """

    share: float
    rest: float
    log_evidence: float
    best: float

    @property
    def temperature(self) -> float:
        """By how much the likelihood is coarsened."""
        return 1.0 + FORM_ALIKE**2 * max(self.best - self.log_evidence, 0.0)


def missing_of(hypotheses: Sequence[Hypothesis]) -> Missing:
    """What the empty set among them leaves."""
    base = next(h for h in hypotheses if not h.effects)
    best = max(float(h.log_evidence.max()) for h in hypotheses)
    return Missing(base.share, base.rest, float(base.log_evidence.max()), best)


def log_masses(h: Hypothesis, missing: Missing) -> tuple[float, float]:
    """Log posterior mass, not normalised, of the set with laws that are known, and with something else beside it."""
    shares, evidence = h.profile()
    width = np.log(shares[1] / shares[0])
    form = np.hypot(DECLARED_FORM, FORM * missing.share if h.effects else 0.0)
    left = h.rest / missing.rest if h.effects and np.isfinite(h.rest) and missing.rest > 0.0 else 0.0
    followed = -0.5 * max(left, 0.0) / FORM**2
    known = -0.5 * (shares / form) ** 2
    anything = np.log(-np.expm1(np.minimum(known + followed, -1e-12)))
    known, anything = (p - np.logaddexp.reduce(p) - np.log(width) for p in (known, anything))
    prior = log_prior_of_set(len(h.effects)) + np.log(width)
    coarse = evidence / missing.temperature
    within = float(np.logaddexp.reduce(coarse + known)) + followed + prior + np.log(1.0 - ELSE)
    beyond = float(np.logaddexp.reduce(coarse + anything)) + prior + np.log(ELSE)
    return (within if usable(h) else -np.inf), beyond


def decide_by_mass(hypotheses: list[Hypothesis]) -> PosteriorDecision:
    """The verdict over hypotheses, one a set of effects, the empty set among them."""
    missing = missing_of(hypotheses)
    logs = np.array([log_masses(h, missing) for h in hypotheses])
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
        return PosteriorDecision("unknown", (), unexplained, (), (), masses, leading, ())
    total, credible = 0.0, list[int]()
    for k in order:
        total += mass[k, 0]
        # A set that holds a credible one says no more than it: its further effects are not supported.
        if not any(set(hypotheses[c].effects) < set(hypotheses[k].effects) for c in credible if c != empty):
            credible.append(int(k))
        if total >= CREDIBLE * (1.0 - unexplained):
            break
    sets = tuple((hypotheses[k].effects, float(mass[k, 0])) for k in credible)
    leading = hypotheses[credible[0]]
    rivals = tuple(hypotheses[k] for k in credible[1:])
    certain = tuple(name for name in leading.effects if all(name in effects for effects, _ in sets))
    if credible[0] == empty or mass[empty, 0] >= 0.5:
        return PosteriorDecision(
            "nothing_missing", (), float(mass[empty, 0]), (), sets, masses, hypotheses[empty], rivals
        )
    if certain:
        holding = sum(float(m[0]) for h, m in zip(hypotheses, mass, strict=True) if set(certain) <= set(h.effects))
        return PosteriorDecision("effect", certain, holding, certain, sets, masses, leading, rivals)
    union = sorted({name for effects, _ in sets for name in effects}, key=lambda name: -masses[name])
    return PosteriorDecision(
        "group", tuple(union), float(total - mass[empty, 0] * (empty in credible)), (), sets, masses, leading, rivals
    )
