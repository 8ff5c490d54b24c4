"""The posterior of a hypothesis: the declared model with some absent effects, fitted under the one likelihood.

    evidence(a) = integral over all unknowns of  N(residuals; 0, covariance(a))  prior(unknowns)
               ~= exp(-|w|^2 / 2) / sqrt(det covariance(a))  prior(unknowns)  sqrt(det 2 pi N^-1)         (Laplace)

w: residuals whitened by the latent force's filter (inference.latent_force) at the share a of unknown forces, priors
included; N: their Gauss-Newton information. Strengths have a Cauchy prior of their nominal size, shapes a flat one
between their bounds. The base parameters' and initial states' priors are those of every hypothesis, and are left out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, lru_cache, partial

import numpy as np
from scipy.interpolate import CubicSpline

from affine_model.curvature import Array
from inference.deferred_correction import Effort, corrected, minimised_at_step
from inference.evidence import evidence_beside
from inference.fit import Fit, linearised_fit, minimised, split
from inference.latent_force import Filter, LatentForce
from inference.linearise import latent_forces
from inference.motion import NO_MOTION, ShownMotion
from inference.pose import PosteriorPose
from inference.trajectory import Problem
from tentacle.solver_result import RESULTS

FORCE_SHARES = np.geomspace(0.001, 0.5, 12)
PIECE_FRAMES = 60  # of a recording: a second of most, longer than what an error is correlated over
KEPT_FILTERS = 3  # of the shares next to each other: more would take most of the memory of a diagnosis
NOISE_REACH = 2.0  # standard deviations of a mean square over pure noise
ROUGHLY, CLOSELY = 1e-3, 5e-5  # tolerances of a fit, shares of its sum of squares: some nats, a tenth of a nat
WHOLE = Effort(tolerance=1e-4)  # of a model that is fitted alone
FIRST = replace(WHOLE, rounds=10, passes=1)  # after which one of two starts goes on; chosen, for speed


@dataclass(frozen=True)
class Hypothesis:
    """The declared model with some absent effects added, fitted at the share of unknown forces that fits it best.

    log_evidence (A,) [nats] at each of FORCE_SHARES. alone: the model fitted without unknown forces (None: not fitted
    yet). rest [noise variances]: mean square of its residual beyond noise (nan: not known yet), over so many rows;
    rest_in_time (C,): the same in pieces of about PIECE_FRAMES frames.
    baseline_share: of unknown forces that the complete recordings need by themselves (0: there is none). baseline_rest:
    as rest, that these recordings let expect in the others, which move more or less.
    baseline_coarsening: by which the likelihood must be coarsened so that no absent effect is named there.
    motion: that the recordings show, its nats beside the smallest share of unknown forces.
    fitted_at: place among FORCE_SHARES of the share beside which it was fitted. poses: posterior of the camera's pose
    beside each of FORCE_SHARES.
    """

    effects: tuple[str, ...]
    problem: Problem
    fitted: Fit
    forces: tuple[LatentForce, ...]
    log_evidence: Array
    alone: Fit | None = None
    rest: float = float("nan")
    rows: int = 0
    rest_in_time: Array = field(default_factory=lambda: np.zeros(0))
    baseline_share: float = 0.0
    baseline_rest: float = 0.0
    baseline_coarsening: float = 1.0
    motion: ShownMotion = NO_MOTION
    fitted_at: int = 0
    poses: tuple[PosteriorPose, ...] = ()

    @property
    def structured(self) -> float:
        """Nats by which the residual of the model alone exceeds what noise may leave; inf while it is not known."""
        if not np.isfinite(self.rest):
            return float("inf")
        return 0.5 * self.rows * max(self.rest - self.noise_reach, 0.0)

    @property
    def rest_of_judged(self) -> float:
        """The rest in the recordings that are not declared complete; in all of them where its pieces are not known."""
        return float(np.mean(self.rest_in_time)) if self.rest_in_time.size else self.rest

    @property
    def noise_reach(self) -> float:
        """The rest [noise variances] that noise may leave by chance."""
        return NOISE_REACH * float(np.sqrt(2.0 / max(self.rows, 1)))

    @property
    def share(self) -> float:
        """The most likely share of unknown forces beside this model."""
        fine, values = self.profile()
        return float(fine[np.argmax(values)])

    def evidence_at(self, coarsening: float) -> Array:
        """The log evidence (A,) with the camera's pose known as well as a decision of this coarsening asks for."""
        gained = [one.evidence_gained(coarsening) for one in self.poses]
        return self.log_evidence + np.array(gained) if gained else self.log_evidence

    def profile(self, coarsening: float = 1.0) -> tuple[Array, Array]:
        """Finely spaced shares, and the log evidence there; between FORCE_SHARES a cubic spline in log a."""
        fine = np.geomspace(FORCE_SHARES[0], FORCE_SHARES[-1], 241)
        coarse = self.evidence_at(coarsening)
        return fine, np.asarray(CubicSpline(np.log(FORCE_SHARES), coarse)(np.log(fine)))

    def highest(self, coarsening: float = 1.0) -> float:
        """The log evidence [nats] at the most likely share."""
        return float(self.profile(coarsening)[1].max())


@dataclass(frozen=True)
class RoughFit:
    """A problem fitted roughly at a given share of unknown forces. cost [nats]: half its sum of squares."""

    effects: tuple[str, ...]
    problem: Problem
    nuisances: tuple[Array, ...]
    cost: float


def rough_fit(
    effects: tuple[str, ...],
    starts: Sequence[tuple[Problem, tuple[Array, ...]]],
    forces: tuple[LatentForce, ...],
    share: float,
) -> RoughFit:
    """Fit a problem roughly from several starts and return the best.

    The share of unknown forces is what is missing without the effects. So large a share widens the minimum, and the fit
    finds it from far away.
    """
    filters = tuple(force.filter(share) for force in forces)
    found = []
    for problem, nuisances in starts:
        unknowns = np.concatenate([problem.parameters[problem.rows()], *nuisances])
        rough = corrected(replace(problem, filters=filters), unknowns)
        unknowns, lowest = minimised(rough, nuisances, tolerance=ROUGHLY, most=30)
        found.append(RoughFit(effects, *_moved(replace(problem, filters=filters), unknowns), lowest.cost))
    return min(found, key=lambda one: one.cost)


def baseline_alone(problem: Problem, nuisances: tuple[Array, ...]) -> Hypothesis:
    """The declared model fitted to the complete recordings alone."""
    both = [(e, n) for e, n in zip(problem.experiments, nuisances, strict=True) if e.complete]
    experiments = tuple(replace(e, varies=(), complete=False) for e, _ in both)
    own = tuple(n[: len(n) - len(e.varies)] for e, n in both)
    return declared_model(replace(problem, experiments=experiments), own)


def declared_model(problem: Problem, nuisances: tuple[Array, ...]) -> Hypothesis:
    """The declared model, fitted from the end of a fit without unknown forces."""
    return fit_hypothesis(RoughFit((), problem, nuisances, 0.0))


def fit_hypothesis(rough: RoughFit, declared: tuple[LatentForce, ...] = ()) -> Hypothesis:
    """Fit the problem at the share of unknown forces that has the largest evidence.

    With a smaller share a fit may follow the data far better. Therefore the best share is found again after each fit.
    declared: the latent forces about the declared model's run (none: this is that model). LinAlgError where the run
    leaves all bounds beside the fit, so that no evidence is known.
    """
    problem, nuisances = rough.problem, rough.nuisances
    return _fit_beside(rough, latent_forces(problem, problem.parameters, nuisances, rough.effects, declared))


def continued(h: Hypothesis) -> Hypothesis:
    """The hypothesis with its fit begun again where it ended, beside the same unknown forces."""
    problem = replace(h.problem, parameters=h.fitted.parameters, filters=())
    return _fit_beside(RoughFit(h.effects, problem, h.fitted.nuisances, h.fitted.misfit), h.forces)


def _fit_beside(rough: RoughFit, forces: tuple[LatentForce, ...]) -> Hypothesis:
    """The fit of a problem at the share of these unknown forces that has the largest evidence."""
    problem, nuisances = rough.problem, rough.nuisances
    filters = lru_cache(KEPT_FILTERS)(partial(filters_at, forces))
    unknowns = np.concatenate([problem.parameters[problem.rows()], *nuisances])
    fitted = linearised_fit(corrected(problem, unknowns), unknowns, 0)
    tried, last = set[int](), 0
    while True:
        evidence = cache(lambda place, problem=problem, fitted=fitted: evidence_beside(problem, fitted, filters(place)))
        best = _climbed(lambda place, evidence=evidence: evidence(place).log, last)
        if best in tried:  # the fit is at its share: now all shares are needed
            beside = [evidence(place) for place in range(len(FORCE_SHARES))]
            evidences, poses = np.array([one.log for one in beside]), tuple(one.pose for one in beside)
            best = int(np.argmax(evidences))
            if best in tried:
                return Hypothesis(rough.effects, problem, fitted, forces, evidences, fitted_at=last, poses=poses)
        tried.add(best)
        last = best
        problem = replace(problem, filters=filters(best))
        unknowns, lowest, coarse = minimised_at_step(problem, nuisances, Effort(CLOSELY))
        problem, nuisances = _moved(problem, unknowns)
        fitted = replace(linearised_fit(coarse, unknowns, 0), result=lowest.result)


def _climbed(evidence: Callable[[int], float], place: int) -> int:
    """The place among FORCE_SHARES of the first maximum of the evidence, uphill from a place."""
    while True:
        beside = [k for k in (place - 1, place + 1) if 0 <= k < len(FORCE_SHARES)]
        best = max((place, *beside), key=evidence)
        if best == place:
            return place
        place = best


def without_derivatives(h: Hypothesis) -> Hypothesis:
    """The hypothesis without its filters and derivatives, which take a hundred times the memory of all else."""
    return replace(h, problem=replace(h.problem, filters=()), fitted=_without_slopes(h.fitted))


def _without_slopes(fitted: Fit) -> Fit:
    return replace(fitted, jacobian=np.zeros((0, 0)), slopes=())


def with_derivatives(h: Hypothesis) -> Hypothesis:
    """The hypothesis with the filters and derivatives that `without_derivatives` took away."""
    if h.problem.filters:
        return h
    problem = replace(h.problem, filters=filters_at(h.forces, h.fitted_at))
    unknowns = np.concatenate([h.fitted.values, *h.fitted.nuisances])
    again = linearised_fit(corrected(problem, unknowns), unknowns, h.fitted.evaluations)
    return replace(h, problem=problem, fitted=replace(again, result=h.fitted.result))


def with_rest(h: Hypothesis, nested: Hypothesis | None = None) -> Hypothesis:
    """The hypothesis with its rest: the model alone is fitted to follow the data as closely as possible.

    Its residual counts as noise, so that no parameter leaves its prior. nested: a submodel of this one with its rest.
    If this fit has a larger rest than the submodel after its FIRST rounds, it is begun from the submodel's parameters
    too, and the better one goes on: a law that yields may creep along a wrong valley for hundreds of rounds.
    """
    there = np.concatenate([h.fitted.values, *h.fitted.nuisances])
    plain = replace(h.problem, filters=())
    size = max(float(np.sqrt(np.mean(_seen_rows(plain, plain.residuals(there[:, None])[1]) ** 2))), 1.0)
    best = _followed(h, plain, h.fitted.nuisances, size, FIRST)
    if nested is not None and best.rest > nested.rest:
        again, start = _begun_at(nested, h)
        best = min(best, _followed(h, again, start, float(np.sqrt(nested.rest + 1.0)), FIRST), key=lambda one: one.rest)
    assert best.alone is not None
    return _followed_further(best, WHOLE) if best.alone.result is RESULTS.MAX_STEPS else best


def _begun_at(nested: Hypothesis, h: Hypothesis) -> tuple[Problem, tuple[Array, ...]]:
    """The model alone with the parameters of a submodel that was fitted alone, and the nuisances to begin with."""
    assert nested.alone is not None
    parameters, before = h.problem.parameters.copy(), nested.alone.parameters
    for name in nested.problem.free:
        place = h.problem.rows()[h.problem.free.index(name)]
        parameters[place] = before[place]
    kept = all(a.size == b.size for a, b in zip(nested.alone.nuisances, h.fitted.nuisances, strict=True))
    start = nested.alone.nuisances if kept else h.fitted.nuisances
    return replace(h.problem, filters=(), parameters=parameters), start


def followed_closely(h: Hypothesis) -> Hypothesis:
    """The hypothesis with the fit of its model alone continued to a small tolerance."""
    return _followed_further(h, Effort(tolerance=1e-7))


def _followed_further(h: Hypothesis, effort: Effort) -> Hypothesis:
    """The hypothesis with the fit of its model alone begun again at its end."""
    assert h.alone is not None
    plain = replace(h.problem, filters=(), parameters=h.alone.parameters)
    again = _followed(h, plain, h.alone.nuisances, float(np.sqrt(max(h.rest, 0.0) + 1.0)), effort)
    return min(h, again, key=lambda one: one.rest)


def _followed(h: Hypothesis, plain: Problem, nuisances: tuple[Array, ...], size: float, effort: Effort) -> Hypothesis:
    """Fit the model alone, with noise `size` times its standard deviation, which is coarse enough by itself."""
    louder = tuple(replace(e, noise_gain=size * e.noise_gain, coarsening=1.0) for e in plain.experiments)
    plain = replace(plain, experiments=louder)
    unknowns, lowest, coarse = minimised_at_step(plain, nuisances, effort)
    alone = replace(linearised_fit(coarse, unknowns, lowest.rounds), result=lowest.result)
    rows = _seen_rows(plain, [rows[:, :, None] for rows in alone.residuals])
    pieces = [
        size**2 * float(np.mean(piece[piece != 0.0] ** 2)) - 1.0
        for e, residuals in zip(plain.experiments, alone.residuals, strict=True)
        if not e.complete
        for piece in np.array_split(residuals[e.used], max(1, round(int(e.used.sum()) / PIECE_FRAMES)))
        if np.any(piece != 0.0)
    ]
    rest = float(size**2 * np.mean(rows**2)) - 1.0
    return replace(h, alone=_without_slopes(alone), rest=rest, rows=rows.size, rest_in_time=np.array(pieces))


def _seen_rows(problem: Problem, residuals: Sequence[Array]) -> Array:
    """Whitened residuals (T, K, 1) of each recording as one row, on the used frames and without rows that were not
    seen.
    """
    rows = np.concatenate([r[e.used].ravel() for e, r in zip(problem.experiments, residuals, strict=True)])
    return np.asarray(rows[rows != 0.0])


def _moved(problem: Problem, unknowns: Array) -> tuple[Problem, tuple[Array, ...]]:
    parameters, nuisances = split(problem, unknowns)
    return replace(problem, parameters=parameters), nuisances


def filters_at(forces: tuple[LatentForce, ...], place: int, coarsening: float = 1.0) -> tuple[Filter, ...]:
    """The filters of every recording at that one of FORCE_SHARES; coarsening: see LatentForce.filter."""
    return tuple(force.filter(FORCE_SHARES[place], coarsening) for force in forces)
