"""The score test: how much of the residual each absent effect would explain, to first order, from one batch.

    gain = 1/2 |P_S r|^2 [nats],        S = (1 - B B') S_raw

r is the whitened residual of the fitted model, S_raw the sensitivity to an effect's strengths, and B an orthonormal
basis of the columns of the model's Jacobian: a refit of the model's own parameters can absorb them. P_S projects on S.
Source: Rao 1948.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.signal import find_peaks

from affine_model.arm import parameter_index
from affine_model.curvature import Array
from affine_model.effect import Effect
from affine_model.effects import absent_effects
from inference.trajectory import Fit, ParameterName, Problem
from tentacle.specimen import declared_effects

STRENGTH_STEP = 0.02  # of the nominal strength: small enough to be linear, large enough for the integrator's noise
BAND, RESOLUTION, PEAKS = (0.2, 4.0), 0.005, 4  # Hz, Hz, how many: of the residual's own spectrum
SCORE_BATCH = 96  # individuals at once: what memory holds for a long recording
VISIBLE_STRENGTH = 1e-3  # an effect whose nominal strength moves the data by less than this (whitened norm) is dead


@dataclass(frozen=True)
class Candidate:
    """An absent effect in the score test.

    gain [nats]; strengths: linear estimates; shapes: the values with the largest gain; sensitivity (N, S): without what
    the base can absorb.
    """

    effect: Effect
    gain: float
    strengths: Array
    shapes: tuple[float, ...]
    sensitivity: Array

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


def sensitivities(
    problem: Problem, fitted: Fit, effects: tuple[Effect, ...]
) -> dict[str, list[tuple[tuple[float, ...], Array]]]:
    """Per effect and shape variant, d residuals / d strengths (N, S), at the fitted state; differences in one batch
    each.
    """
    problem = replace(problem, parameters=fitted.parameters)
    unknowns = np.concatenate([fitted.values, *fitted.nuisances])
    peaks = spectral_peaks(problem, fitted)
    plan = []
    for effect in effects:
        for shapes in _variants(effect, peaks):
            for strength in range(len(effect.strengths)):
                low = effect.strengths[strength].bounds[0]
                for sign in (1.0, -1.0) if low < 0.0 else (1.0, 0.0):
                    plan.append((effect, shapes, strength, sign))
    columns = []
    for begin in range(0, len(plan), SCORE_BATCH):
        part = plan[begin : begin + SCORE_BATCH]
        parameters = np.stack([_trial(problem, *entry) for entry in part], axis=1)
        columns.append(problem.residuals_of(parameters, np.repeat(unknowns[:, None], len(part), axis=1)))
    values = np.concatenate(columns, axis=1)
    found: dict[str, list[tuple[tuple[float, ...], Array]]] = {}
    place = 0
    for effect in effects:
        for shapes in _variants(effect, peaks):
            parts = []
            for parameter in effect.strengths:
                spread = STRENGTH_STEP * parameter.nominal * (2.0 if parameter.bounds[0] < 0.0 else 1.0)
                parts.append((values[:, place] - values[:, place + 1]) / spread)
                place += 2
            found.setdefault(effect.name, []).append((shapes, np.stack(parts, axis=1)))
    return found


def nuisance_tangent_basis(fitted: Fit) -> Array:
    """Orthonormal basis (N, P) of what a refit of the model's own parameters and initial states can absorb."""
    scaled = fitted.jacobian / np.maximum(np.linalg.norm(fitted.jacobian, axis=0), 1e-300)
    left, singular, _ = np.linalg.svd(scaled, full_matrices=False)
    return left[:, singular > 1e-9 * singular[0]]


def score(problem: Problem, fitted: Fit, effects: tuple[Effect, ...] | None = None) -> list[Candidate]:
    """All candidate effects, best first, without those that these data cannot show."""
    chosen = tuple(e for e in (effects or absent_effects()) if e.strengths)
    basis = nuisance_tangent_basis(fitted)
    residual = fitted.used_residuals - basis @ (basis.T @ fitted.used_residuals)
    names = {name for name, _ in problem.free} | set(declared_effects(problem.arm.specimen, problem.arm.fluid))
    no_fluid = problem.arm.fluid.density == 0.0
    chosen = tuple(e for e in chosen if e.name not in names and not (no_fluid and e.family == "fluid"))
    table = sensitivities(problem, fitted, chosen)
    candidates = []
    for effect in chosen:
        nominal = np.array([parameter.nominal for parameter in effect.strengths])
        best: Candidate | None = None
        for shapes, raw in table[effect.name]:
            freed = raw - basis @ (basis.T @ raw)
            visible = np.linalg.norm(freed * nominal, axis=0) > VISIBLE_STRENGTH * np.sqrt(residual.size)
            if not visible.any():
                continue
            strengths = np.zeros(nominal.size)
            solution, *_ = np.linalg.lstsq(freed[:, visible] * nominal[visible], -residual, rcond=1e-8)
            strengths[visible] = solution * nominal[visible]
            explained = freed @ strengths
            gain = float(-residual @ explained - 0.5 * explained @ explained)
            if best is None or gain > best.gain:
                best = Candidate(effect, gain, strengths, shapes, freed)
        if best is not None:
            candidates.append(best)
    return sorted(candidates, key=lambda candidate: -candidate.gain)


def twin_cosines(candidates: list[Candidate]) -> Array:
    """Largest canonical cosine of each pair of sensitivities. At 1 these data cannot separate the pair."""
    bases = [np.linalg.qr(candidate.sensitivity)[0] for candidate in candidates]
    result = np.eye(len(bases))
    for a, first in enumerate(bases):
        for b, second in enumerate(bases[:a]):
            result[a, b] = result[b, a] = np.linalg.norm(first.T @ second, 2)
    return result
