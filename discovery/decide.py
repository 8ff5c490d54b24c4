"""From hypotheses to a verdict, by posterior mass alone.

    P(set, known | y) ~ (1 - ELSE) P(set)   int  k(a, r)      evidence(set, a, T)^(1/T) d log a
    P(set, else  | y) ~ ELSE P(set | else)  int (1 - k(a, r)) evidence(set, a, T)^(1/T) d log a
    k = exp(-a^2 / 2 s^2 - r^2 / 2 q^2),  s^2 = d^2 + (FORM a_0)^2,  q^2 = b^2 + (FORM r_0)^2
    T = max(1 + min(f^2 G, D), 1 + g^2 M / odds(1), 1 + ANOTHER_DAY (T_b - 1))
    f = min(FORM_ALIKE, a_1 / a_0),  g = min(DECLARED_ALIKE, m_1 / FORM)
    T_b = max over sets of B(set) / odds(set)
    odds(set) = log P(none) - log P(set)

a is the share of the acting forces that no law of the set explains (inference.latent_force), with a prior that is flat
in its logarithm. The form of a law is known only approximately. The declared laws therefore leave a share d of the
acting forces: DECLARED_FORM, or what the baseline's recordings need by themselves; added laws leave a share of FORM of
the force a_0 that is missing without them. r^2 is the residual beyond noise that the set's model alone leaves in the
recordings that are judged, and r_0^2 the one without the set, for which a_0 and r_0 in s and q are 0. b^2 is the
residual that the declared model leaves in the baseline, times the motion's power over that in the baseline
(inference.motion), or DECLARED_FORM^2 of the motion's power if that is more: a steady force of a share d could explain
an error that the baseline has nothing like. Without a baseline b is not known, and the residual without a set says
nothing. "Something else" (ELSE) means that more is left than the forms allow. The set then only imitates it, and none,
one, two and three effects are equally likely to do so best: P(set | else).

An error of form can also look like another effect: of the G nats that the best set gains, such an effect can gain f^2
G, and no more than the D nats by which the residual of the best set's model alone exceeds its noise. f is at most
FORM_ALIKE, and at most the share a_1 of unknown forces that the best set leaves, relative to the a_0 without it: an
error of form that looks like an effect in part is an unknown force in the other part. The likelihood is therefore
coarsened by T (Miller and Dunson 2019, Robust Bayesian inference via coarsening). What is known of the set-up does not
depend on the form of laws, and is not coarsened: in evidence(set, a, T) the prior variance of the camera's pose is T
times smaller (inference.pose). A baseline measures the errors of form: there a set would gain B(set) nats, although
none acts, and with T_b no set is named. In another recording they look like effects by other amounts: of two recordings
the second has the larger gain as often as the first. The largest of some eight independent squares exceeds ANOTHER_DAY
times another such largest one in a case of twenty. The declared laws may err by a share DECLARED_ALIKE of the motion
that looks like an effect: in M nats of motion (inference.motion) such an effect gains DECLARED_ALIKE^2 M, and one
effect is not named for it. In 19 development recordings of two plants without an effect, the best set gained at most
.00095^2 M, and the constant is 1.5 times that; in 16 later ones at most .00072^2 M, but once .00147^2 M. One of these
plants took steps of first order. Of plants that do not, a third of the constant would be right, and for other people's
programs it would not (docs/loop_trials.md). But such an error is no law of the catalogue. It differs from one by FORM
or more, as the published forms of one law do: where the model of the best set alone leaves a share m_1 of the motion,
the error looks like an effect by no more than m_1 / FORM.

The verdict is the outcome with the largest mass. The credible sets are the fewest sets that, with all sets that contain
them, hold CREDIBLE of the known mass: whether more acts beside them is another question. What they share is the answer
if one of them holds nothing else; otherwise all of them are a group, for another effect acts beside what they share,
and its name is open.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from math import comb

import numpy as np

from affine_model.curvature import Array
from affine_model.effects import absent_effects, catalogue
from inference.fit import Fit
from inference.motion import ShownMotion
from inference.posterior import Hypothesis
from tentacle.diagnosis import Verdict
from tentacle.solver_result import RESULTS

# Half and double of each of these constants: docs/loop_trials.md, benchmarks/sensitivity.py.
COMPLETE = (0.4, 0.4, 0.15, 0.05)  # prior of none, one, two and three effects missing: chosen
ELSE = 0.15  # prior of something outside the catalogue: chosen
DECLARED_FORM = 0.003  # share of the acting forces that the declared laws leave
# The next was chosen while looking at the recordings of the silicone beam; its sensitivity is not measured.
MOST_DECLARED_FORM = 0.05  # the same on a baseline: one whose model leaves more proves nothing
DECLARED_ALIKE = 0.0015  # share of the motion in which two programs of the same laws differ as if an effect acted
FORM = 0.22  # share of what an added law explains that its true form may differ by: 10 to 36 % are known cases
FORM_ALIKE = 0.15  # share of it that resembles another effect
ANOTHER_DAY = 4.0  # ratio of the largest of eight squares of normal numbers to another such: 1 in 20 is beyond
CREDIBLE = 0.95


@dataclass(frozen=True)
class PosteriorDecision:
    """The verdict, its effects and its posterior mass. unexplained: mass of something else.

    certain: effects that are in every credible set; the answer if one of these sets holds nothing else. sets: the
    credible sets with the mass that each and those that contain it hold. masses: effect -> posterior mass of all sets
    that contain it. leading, rivals: hypotheses of the credible sets.
    """

    verdict: Verdict
    effects: tuple[str, ...]
    confidence: float
    certain: tuple[str, ...]
    sets: tuple[tuple[tuple[str, ...], float], ...]
    masses: dict[str, float]
    leading: Hypothesis
    rivals: tuple[Hypothesis, ...]
    unexplained: float


def log_prior_of_set(count: int) -> float:
    """Log prior of one set of so many effects."""
    return float(np.log(COMPLETE[count] / comb(len(absent_effects()), count)))


def log_prior_of_imitation(count: int) -> float:
    """Log prior that one set of so many effects imitates something outside the catalogue best."""
    return float(-np.log(len(COMPLETE) * comb(len(absent_effects()), count)))


def odds_against(count: int) -> float:
    """Nats that one set of so many effects must gain to be as likely as none."""
    return log_prior_of_set(0) - log_prior_of_set(count)


def baseline_coarsening(gains: Iterable[tuple[int, float]]) -> float:
    """T with which no set is named on another day. gains: the number of a set's effects, and what it would gain in the
    baseline [nats].
    """
    there = max((gain / odds_against(count) for count, gain in gains), default=1.0)
    return 1.0 + ANOTHER_DAY * max(there - 1.0, 0.0)


def added_coarsening(gained: float, structured: float, left: float) -> float:
    """T that the form of added laws asks for, which gain so many nats and leave so many of a residual beyond noise;
    left: the share of unknown forces beside them, relative to that without them.
    """
    return 1.0 + min(min(FORM_ALIKE, left) ** 2 * gained, structured)


def form_coarsening(motion: float, left: float = np.inf) -> float:
    """T that the form of the declared laws asks for in so many nats of motion, of which the model of the best set alone
    leaves this share.
    """
    return 1.0 + min(DECLARED_ALIKE, left / FORM) ** 2 * motion / odds_against(1)


def motion_left(h: Hypothesis, motion: ShownMotion) -> float:
    """The share of the motion that a hypothesis' model alone leaves, what noise may hide included; inf where it is not
    known yet.
    """
    return motion.share_of(max(h.rest_of_judged, 0.0) + h.noise_reach) if np.isfinite(h.rest) else float("inf")


def bounds_met(fitted: Fit, effects: Iterable[str]) -> bool:
    """Whether a strength or a relaxation time of these effects stands at a bound of what is physically possible: they
    explain nothing. A memory that relaxes at once is a damping, and one that never does is a change of shape.
    """
    limited = {
        (name, parameter.name)
        for name in effects
        for parameter in (
            catalogue()[name].parameters
            if catalogue()[name].relaxation_time is not None
            else catalogue()[name].strengths
        )
    }
    return any(name in limited for name in fitted.at_bound)


def stands_at_bound(h: Hypothesis) -> bool:
    """Whether one of its effects does."""
    return bounds_met(h.fitted, h.effects)


def usable(h: Hypothesis) -> bool:
    """Whether a hypothesis may be named: its fit converged, and no strength stands at a bound."""
    return h.fitted.result is not RESULTS.MAX_STEPS and not stands_at_bound(h)


@dataclass(frozen=True)
class Missing:
    """What the declared model leaves unexplained.

    share: of the acting forces. rest [noise variances]: residual beyond noise. gained [nats]: by the best set, which
    leaves a share of `left`; its model alone leaves a residual of `structured` nats beyond noise. declared: share of
    the acting forces that the form of the declared laws leaves, and declared_rest the residual [noise variances].
    baseline_coarsening: see Hypothesis. motion [nats]: see inference.motion; motion_left: the share of it that the best
    set's model alone leaves, and least_left that a set would leave which explains all but noise (inf: not known).
    """

    share: float
    rest: float
    gained: float
    left: float
    structured: float
    declared: float
    declared_rest: float = 0.0
    baseline_coarsening: float = 1.0
    motion: float = 0.0
    motion_left: float = np.inf
    least_left: float = np.inf

    @property
    def temperature(self) -> float:
        """T: the factor by which the likelihood is coarsened."""
        added = added_coarsening(self.gained, self.structured, self.left / self.share)
        return max(added, form_coarsening(self.motion, self.motion_left), self.baseline_coarsening)

    @property
    def least_temperature(self) -> float:
        """T where a set that is not tried yet explains all but noise."""
        return max(form_coarsening(self.motion, self.least_left), self.baseline_coarsening)


def missing_of(hypotheses: Sequence[Hypothesis]) -> Missing:
    """What the hypothesis without effects leaves unexplained."""
    base = next(h for h in hypotheses if not h.effects)
    # A baseline that leaves more than MOST_DECLARED_FORM proves nothing, so that no more than this counts as its own.
    counted = min(1.0, MOST_DECLARED_FORM / max(base.baseline_share, 1e-12))
    form, rest = max(DECLARED_FORM, counted * base.baseline_share), counted**2 * base.baseline_rest
    best = max((h for h in hypotheses if not stands_at_bound(h)), key=lambda h: h.highest())
    gained = best.highest() - base.highest()
    shares = motion_left(best, base.motion), base.motion.share_of(base.noise_reach)
    told = (form, rest, base.baseline_coarsening, base.motion.nats, *shares)
    return Missing(base.share, base.rest_of_judged, gained, best.share, best.structured, *told)


def log_masses(h: Hypothesis, missing: Missing) -> tuple[float, float]:
    """Log posterior mass, not normalised, of the set with known laws alone, and with something else beside them."""
    if stands_at_bound(h):
        return -np.inf, -np.inf
    shares, evidence = h.profile(missing.temperature)
    width = np.log(shares[1] / shares[0])
    added = FORM if h.effects else 0.0
    form = np.hypot(missing.declared, added * missing.share)
    form_rest = missing.declared_rest + added**2 * max(missing.rest, 0.0)
    left = max(h.rest_of_judged - h.noise_reach, 0.0) if np.isfinite(h.rest) else 0.0
    # Without a baseline nothing is known of what the declared laws leave, and form_rest is 0 where nothing is added.
    followed = -0.5 * left / form_rest if form_rest > 0.0 else 0.0
    known = -0.5 * (shares / form) ** 2
    anything = np.log(-np.expm1(np.minimum(known + followed, -1e-12)))
    known, anything = (p - np.logaddexp.reduce(p) - np.log(width) for p in (known, anything))
    coarse, count = evidence / missing.temperature + np.log(width), len(h.effects)
    within = float(np.logaddexp.reduce(coarse + known)) + followed + log_prior_of_set(count) + np.log(1.0 - ELSE)
    beyond = float(np.logaddexp.reduce(coarse + anything)) + log_prior_of_imitation(count) + np.log(ELSE)
    return (within if usable(h) else -np.inf), beyond


def decide_by_mass(hypotheses: list[Hypothesis], refuted: Collection[tuple[str, ...]] = ()) -> PosteriorDecision:
    """The verdict over hypotheses, one for each set of effects and one without effects. refuted: sets that cannot be
    all that acts, whatever their evidence.
    """
    missing = missing_of(hypotheses)
    logs = np.array([log_masses(h, missing) for h in hypotheses])
    logs[[h.effects in refuted for h in hypotheses], 0] = -np.inf
    mass = np.exp(logs - np.logaddexp.reduce(logs.ravel()))
    unexplained = float(mass[:, 1].sum())
    empty = next(k for k, h in enumerate(hypotheses) if not h.effects)
    masses: dict[str, float] = {}
    for h, (within, beyond) in zip(hypotheses, mass, strict=True):
        for name in h.effects:
            masses[name] = masses.get(name, 0.0) + float(within + beyond)
    if unexplained >= 0.5:
        leading = hypotheses[int(np.argmax(mass[:, 1]))]
        return PosteriorDecision("unknown", (), unexplained, (), (), masses, leading, (), unexplained)
    credible = _credible(hypotheses, mass[:, 0], CREDIBLE * (1.0 - unexplained))
    total, sets = sum(credible.values()), tuple((hypotheses[k].effects, held) for k, held in credible.items())
    first, *others = credible
    leading, rivals = hypotheses[first], tuple(hypotheses[k] for k in others)
    certain = tuple(name for name in leading.effects if all(name in effects for effects, _ in sets))
    if first == empty or mass[empty, 0] >= 0.5:
        held = float(mass[empty, 0])
        return PosteriorDecision("nothing_missing", (), held, (), sets, masses, hypotheses[empty], rivals, unexplained)
    # What all credible sets share is the whole answer if one of them holds nothing else.
    exact = [k for k in credible if certain and set(hypotheses[k].effects) == set(certain)]
    if exact:  # the set that holds nothing else is the answer's model, though one with a further effect may have more
        leading, rivals = hypotheses[exact[0]], tuple(hypotheses[k] for k in credible if k != exact[0])
        holding = sum(float(m[0]) for h, m in zip(hypotheses, mass, strict=True) if set(certain) <= set(h.effects))
        return PosteriorDecision("effect", certain, holding, certain, sets, masses, leading, rivals, unexplained)
    union = sorted({name for effects, _ in sets for name in effects}, key=lambda name: -masses[name])
    named = total - credible.get(empty, 0.0)
    return PosteriorDecision("group", tuple(union), named, certain, sets, masses, leading, rivals, unexplained)


def _credible(hypotheses: Sequence[Hypothesis], mass: Array, asked: float) -> dict[int, float]:
    """Places of the credible sets, the largest first, and the mass that each holds with all sets that contain it; no
    set alone, because every set contains it. Together they hold at least what is asked.
    """
    sets = [frozenset(h.effects) for h in hypotheses]
    found: dict[int, float] = {}
    left = set(range(len(sets)))
    for k in np.argsort(-mass, kind="stable").tolist():
        if k not in left:
            continue
        held = {k} | {j for j in left if sets[k] and sets[k] < sets[j]}
        found[k] = float(mass[sorted(held)].sum())
        left -= held
        if sum(found.values()) >= asked:
            break
    return found
