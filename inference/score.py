"""The score test: how much of the residual each absent effect would explain, to first order, from one batch.

    gain = 1/2 |P_S r|^2 [nats],        S = (1 - B B') S_raw

r is the whitened residual of the fitted model, S_raw the sensitivity to an effect's strengths, and B an orthonormal
basis of the columns of the model's Jacobian: a refit of the model's own parameters can absorb them. P_S projects on S.
The sensitivities are simulated once (responses) and whitened beside any share of unknown forces
(inference.whitened_fit). Source: Rao 1948.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.signal import find_peaks

from affine_model.arm import parameter_index
from affine_model.curvature import Array
from affine_model.effect import Effect
from affine_model.effects import absent_effects
from inference.deferred_correction import coarser
from inference.fit import Fit
from inference.trajectory import RAN_AWAY, ParameterName, Problem
from inference.whitened_fit import WhitenedFit
from tentacle.specimen import declared_effects, densest

STRENGTH_STEP = 0.02  # of the nominal strength: small enough to be linear, large enough for the integrator's noise
BAND, RESOLUTION, PEAKS = (0.2, 4.0), 0.005, 4  # Hz, Hz, how many: of the residual's own spectrum
SCORE_BATCH = 96  # individuals at once: what memory holds for a long recording
OTHERS, DISTINCT = 3, 0.7  # further variants of an effect that are kept; cosine under which two explain different parts
VISIBLE_STRENGTH = 1e-3  # an effect whose nominal strength moves the data by less than this (whitened norm) is dead


@dataclass(frozen=True)
class Candidate:
    """An absent effect in the score test.

    gain [nats]; strengths: linear estimates; shapes: the values with the largest gain; sensitivity (N, S): without what
    the base can absorb; others: strengths and shapes of the next best variants that look different in the data.
    """

    effect: Effect
    gain: float
    strengths: Array
    shapes: tuple[float, ...]
    sensitivity: Array
    others: tuple[tuple[Array, tuple[float, ...]], ...] = ()

    @property
    def free(self) -> tuple[ParameterName, ...]:
        """Names of all its parameters."""
        return tuple((self.effect.name, parameter.name) for parameter in self.effect.parameters)


def _variants(effect: Effect, peaks: tuple[float, ...]) -> list[tuple[float, ...]]:
    """All combinations of the shapes' scan values. A frequency also gets the peaks of the residual's spectrum."""
    return list(product(*((*shape.scan, *(peaks if shape.unit == "Hz" else ())) for shape in effect.shapes)))


def spectral_peaks(problem: Problem, fitted: Fit) -> tuple[float, ...]:
    """The PEAKS highest peaks [Hz] of the residuals' power over all channels and recordings, within BAND.

    The width of a spectral line is one over the duration: a fixed scan would miss it.
    """
    frequencies = np.arange(BAND[0], BAND[1], RESOLUTION)
    power = np.zeros(frequencies.size)
    for experiment, residuals in zip(problem.experiments, fitted.residuals, strict=True):
        t, rows = experiment.observation.t[experiment.used], residuals[experiment.used]
        waves = np.exp(-2j * np.pi * frequencies[:, None] * t)
        power += np.sum(np.abs(waves @ (rows - rows.mean(axis=0))) ** 2, axis=1)
    places, _ = find_peaks(power)
    highest = places[np.argsort(-power[places])][:PEAKS]
    return tuple(float(value) for value in np.sort(frequencies[highest]))


def _trial(problem: Problem, effect: Effect, shapes: tuple[float, ...], strength: int, sign: float) -> Array:
    parameters = problem.parameters.copy()
    for shape, value in zip(effect.shapes, shapes, strict=True):
        parameters[parameter_index(effect.name, shape.name)] = value
    parameter = effect.strengths[strength]
    parameters[parameter_index(effect.name, parameter.name)] += sign * STRENGTH_STEP * parameter.nominal
    return parameters


@dataclass(frozen=True)
class Response:
    """How one absent effect, with one choice of its shapes, moves each recording's residuals: slopes (T, K, S), before
    whitening, by its strengths.
    """

    effect: Effect
    shapes: tuple[float, ...]
    slopes: tuple[Array, ...]


def responses(problem: Problem, fitted: Fit, effects: tuple[Effect, ...] | None = None) -> list[Response]:
    """The responses to all absent effects that can act here, at the fitted state; differences in one batch each."""
    chosen = _that_can_act(problem, effects or absent_effects())
    step = problem.step
    problem = replace(problem, parameters=fitted.parameters, filters=(), step=coarser(problem) * step)
    unknowns = np.concatenate([fitted.values, *fitted.nuisances])
    peaks = spectral_peaks(problem, fitted)
    variants = [(effect, shapes) for effect in chosen for shapes in _variants(effect, peaks)]
    plan, widths = [], []
    for effect, shapes in variants:
        for place, strength in enumerate(effect.strengths):
            signs = (1.0, -1.0) if strength.bounds[0] < 0.0 else (1.0, 0.0)
            plan += [_trial(problem, effect, shapes, place, sign) for sign in signs]
            widths.append(STRENGTH_STEP * strength.nominal * (signs[0] - signs[1]))
    slopes = _slopes(problem, unknowns, plan, widths)
    lost = [place for place in range(len(widths)) if not all(np.all(np.isfinite(own[:, :, place])) for own in slopes)]
    if lost:  # such a strength asks for the finer step; one that runs away there too cannot be seen
        finer = replace(problem, step=step)
        trials = [plan[k] for place in lost for k in (2 * place, 2 * place + 1)]
        for own, again in zip(slopes, _slopes(finer, unknowns, trials, [widths[k] for k in lost]), strict=True):
            own[:, :, lost] = np.where(np.isfinite(again).all(axis=(0, 1)), again, 0.0)
    ends = np.cumsum([len(effect.strengths) for effect, _ in variants])[:-1]
    parts = [np.split(own, ends, axis=2) for own in slopes] if plan else []
    return [
        Response(effect, shapes, tuple(own[place] for own in parts)) for place, (effect, shapes) in enumerate(variants)
    ]


def _slopes(problem: Problem, unknowns: Array, plan: list[Array], widths: list[float]) -> list[Array]:
    """Of each recording the differences (T, K, S) between the runs of each pair in the plan, over their widths (S,);
    not finite where one of them ran away.
    """
    slopes: list[list[Array]] = [[] for _ in problem.experiments]
    for begin in range(0, len(plan), SCORE_BATCH):
        parameters = np.stack(plan[begin : begin + SCORE_BATCH], axis=1)
        everything = problem.residuals_everywhere(parameters, np.repeat(unknowns[:, None], parameters.shape[1], axis=1))
        width = np.array(widths[begin // 2 : (begin + SCORE_BATCH) // 2])
        for kept, rows in zip(slopes, everything, strict=True):
            ran_away = np.max(np.abs(rows), axis=(0, 1)) >= RAN_AWAY
            pairs = (rows[:, :, 0::2] - rows[:, :, 1::2]) / width
            kept.append(np.where(ran_away[0::2] | ran_away[1::2], np.nan, pairs))
    return [np.concatenate(kept, axis=2) for kept in slopes] if plan else []


def _that_can_act(problem: Problem, effects: tuple[Effect, ...]) -> tuple[Effect, ...]:
    """The effects with a strength that the model has not yet, with a fluid and a payload where they need one."""
    arms = [experiment.arm(problem.arm) for experiment in problem.experiments]
    fluid = densest(arm.fluid for arm in arms)
    names = {name for name, _ in problem.free} | set(declared_effects(problem.arm.specimen, fluid))
    names |= set(problem.arm.specimen.laws)
    wet, loaded = fluid.density > 0.0, any(arm.specimen.tip_mass > 0.0 for arm in arms)
    return tuple(
        e
        for e in effects
        if e.strengths and e.name not in names and (wet or e.family != "fluid") and (loaded or e.payload_shift is None)
    )


def without_response(problem: Problem, known: Sequence[Candidate]) -> list[Candidate]:
    """The effects that can act, but are no candidates because nothing changes to first order, in their nominal size:
    beside a base without drag, for instance, no current acts.
    """
    seen = {one.effect.name for one in known}
    effects = [one for one in _that_can_act(problem, absent_effects()) if one.name not in seen]
    strengths = [np.array([one.nominal for one in effect.strengths]) for effect in effects]
    return [
        Candidate(effect, 0.0, values, _variants(effect, ())[0], np.zeros((0, values.size)))
        for effect, values in zip(effects, strengths, strict=True)
    ]


def score(white: WhitenedFit, known: Sequence[Response]) -> list[Candidate]:
    """The candidate effects, best first, each with its best shapes, without those that these data cannot show."""
    if not known:
        return []
    columns = white.columns([np.concatenate(own, axis=2) for own in zip(*(one.slopes for one in known), strict=True)])
    information, slope = columns.T @ columns, columns.T @ white.residual
    rounding = white.residual.size * float(np.finfo(np.float64).eps)  # of a sum of N products: Higham 2002, section 3.1
    ends = np.cumsum([len(one.effect.strengths) for one in known])
    variants: dict[str, list[tuple[Candidate, Array]]] = {}
    for one, end in zip(known, ends, strict=True):
        nominal = np.array([parameter.nominal for parameter in one.effect.strengths])
        at = np.arange(end - nominal.size, end)
        size = np.sqrt(np.diag(information)[at]) * nominal
        seen = size > VISIBLE_STRENGTH * np.sqrt(white.residual.size)
        if not seen.any():
            continue
        unit, at_seen = nominal[seen] / size[seen], at[seen]  # strengths that move the data by one
        matrix = information[np.ix_(at_seen, at_seen)] * np.outer(unit, unit)
        solution = np.linalg.lstsq(matrix, -slope[at_seen] * unit, rcond=rounding)[0]
        strengths = np.zeros(columns.shape[1])
        strengths[at_seen] = solution * unit
        gain = -float(slope @ strengths + 0.5 * strengths @ information @ strengths)
        found = Candidate(one.effect, gain, strengths[at], one.shapes, columns[:, at])
        variants.setdefault(one.effect.name, []).append((found, strengths))
    best = (_with_others(of, information) for of in variants.values())
    return sorted(best, key=lambda candidate: -candidate.gain)


def _with_others(variants: list[tuple[Candidate, Array]], information: Array) -> Candidate:
    """The variant with the largest gain, with the next best that explain the data in another way than those before.

    information (S, S): S'S of all columns; each variant comes with the strengths (S,) of all columns that it has.
    """
    best, *rest = sorted(variants, key=lambda one: -one[0].gain)
    chosen = [best]
    for one in rest:
        if len(chosen) > OTHERS:
            break
        explains = one[1] @ information
        sizes = [np.sqrt((explains @ one[1]) * (before @ information @ before)) for _, before in chosen]
        if all(abs(explains @ before) < DISTINCT * size for (_, before), size in zip(chosen, sizes, strict=True)):
            chosen.append(one)
    return replace(best[0], others=tuple((one.strengths, one.shapes) for one, _ in chosen[1:]))


def twin_cosines(candidates: list[Candidate]) -> Array:
    """Largest canonical cosine of each pair of sensitivities. At 1 these data cannot separate the pair."""
    bases = [np.linalg.qr(candidate.sensitivity)[0] for candidate in candidates]
    result = np.eye(len(bases))
    for a, first in enumerate(bases):
        for b, second in enumerate(bases[:a]):
            result[a, b] = result[b, a] = np.linalg.norm(first.T @ second, 2)
    return result
