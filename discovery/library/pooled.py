"""One arm's recordings under parameters that they share: what each says of an effect, and of each parameter.

    x_r = (theta_r, strengths),    theta_r ~ N(line(t_r), spread^2)        a parameter by day (discovery.library.trend)

Each recording's evidence is a Gaussian in x_r (discovery.library.evidence). An effect's estimate in a recording
follows with theta_r summed over under what all recordings together say of it, and with the effects that are found
already, at the strengths and probabilities with which they act there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from affine_model.arm import parameter_rows
from affine_model.effects import catalogue
from discovery.library.evidence import Column, RecordingEvidence
from discovery.library.presence import Estimates, Presence
from discovery.library.trend import Trend, fit_trend
from inference.trajectory import ParameterName
from tentacle.signals import Array

ANGLES = np.pi * np.array([0.0, 0.25, 0.5, 0.75])  # of two strengths in their nominal sizes: .92 of any lies along one
VISIBLE = 1e-3  # of the noise: an effect of nominal strength that moves a recording's data by less is not shown there
SURE_PARAMETER = 1e-3  # of a parameter: how well the line about which a recording's value varies is known at best


@dataclass(frozen=True)
class Direction:
    """A way in which an effect may act: its columns with their weights, strength 1 being of nominal size."""

    effect: str
    columns: tuple[Column, ...]
    weights: tuple[float, ...]


@dataclass(frozen=True)
class KnownEffect:
    """An effect that is found already: its direction, and where it acts (R,), how strongly."""

    direction: Direction
    presence: Presence


@dataclass(frozen=True)
class Pool:
    """The recordings of one arm in time order. days (R,): their times [d]; share: place among the shares of unknown
    forces; lines: the trend of each base parameter; acting: effects that are found already.
    """

    recordings: tuple[RecordingEvidence, ...]
    days: Array
    share: int
    lines: dict[ParameterName, Trend]
    acting: tuple[KnownEffect, ...] = ()

    def with_acting(self, acting: KnownEffect) -> Pool:
        """The pool with one effect more, and its parameters beside it."""
        return with_lines(replace(self, acting=(*self.acting, acting)))


def pool_of(recordings: Sequence[RecordingEvidence], days: Array) -> Pool:
    """The pool of recordings in time order, at the share of unknown forces that explains them best together."""
    share = int(np.argmax(np.sum([one.log_evidence for one in recordings], axis=0)))
    return with_lines(Pool(tuple(recordings), days, share, {}))


def with_lines(pool: Pool) -> Pool:
    """The pool with the trends of its parameters fitted anew."""
    names = dict.fromkeys(name for one in pool.recordings for name in one.free)
    found = [_parameters(pool, place) for place in range(len(pool.recordings))]
    lines = {}
    for name in names:
        values, deviations = (np.array([one.get(name, (np.nan, np.inf))[k] for one in found]) for k in (0, 1))
        lines[name] = fit_trend(pool.days, values, deviations)
    return replace(pool, lines=lines)


def directions(recordings: Sequence[RecordingEvidence]) -> list[Direction]:
    """Every way in which an absent effect may act: each choice of its shapes, and each strength or angle of two."""
    shapes = dict.fromkeys((effect, shapes) for one in recordings for effect, _, shapes in one.columns)
    found = []
    for effect, chosen in shapes:
        strengths = [s.name for s in catalogue()[effect].strengths]
        columns = tuple((effect, name, chosen) for name in strengths)
        if len(strengths) == 2:
            found += [Direction(effect, columns, (float(np.cos(a)), float(np.sin(a)))) for a in ANGLES]
        else:
            found += [Direction(effect, (column,), (1.0,)) for column in columns]
    return found


def estimates_of(pool: Pool, sought: Sequence[Direction]) -> list[Estimates]:
    """Each direction's estimate in each recording."""
    both = [_strengths(pool, place, sought) for place in range(len(pool.recordings))]
    values, deviations = (np.array([one[k] for one in both]) for k in (0, 1))
    coarsening = np.array([one.coarsening for one in pool.recordings])
    return [
        Estimates(values[:, k], deviations[:, k], coarsening, 1.0, _one_sided(direction))
        for k, direction in enumerate(sought)
    ]


def _one_sided(direction: Direction) -> bool:
    strengths = catalogue()[direction.effect].strengths
    return len(strengths) == 1 and strengths[0].bounds[0] >= 0.0


@dataclass(frozen=True)
class _Reduced:
    """One recording: root (K, P + A) of base parameters and acting effects, residual (K,), their prior mean and
    precision (P + A,), in units of their scales.
    """

    root: Array
    residual: Array
    mean: Array
    precision: Array

    def solved(self) -> tuple[Array, Array]:
        """Information (P + A, P + A) and its right hand side."""
        information = self.root.T @ self.root + np.diag(self.precision)
        return information, self.precision * self.mean - self.root.T @ self.residual


def _column(one: RecordingEvidence, root: Array, direction: Direction) -> Array:
    """The direction's column (K,) in a recording; 0 where it cannot act there."""
    total = np.zeros(root.shape[0])
    for column, weight in zip(direction.columns, direction.weights, strict=True):
        if column in one.columns:
            total += weight * root[:, len(one.free) + one.columns.index(column)]
    return total


def _reduced(pool: Pool, place: int, *, shared: bool) -> _Reduced:
    """The recording with the acting effects under their priors; shared: its parameters under theirs."""
    one = pool.recordings[place]
    root, count = one.roots[pool.share], len(one.free)
    columns, mean, precision = [root[:, :count]], np.zeros(count), np.zeros(count)
    if shared:
        for k, name in enumerate(one.free):
            line, size = pool.lines[name], one.scale[k]
            mean[k] = (line.line[place] - one.centre[k]) / size
            precision[k] = 1.0 / ((line.spread / size) ** 2 + (SURE_PARAMETER * line.line[place] / size) ** 2)
    for acting in pool.acting:
        p, c = acting.presence.acts[place], acting.presence.strength
        variance = p * ((acting.presence.varies * c) ** 2 + acting.presence.deviation**2) + p * (1.0 - p) * c**2
        columns.append(_column(one, root, acting.direction)[:, None])
        mean = np.append(mean, p * c)
        precision = np.append(precision, 1.0 / max(variance, 1e-12))
    return _Reduced(np.concatenate(columns, axis=1), root[:, -1], mean, precision)


def _scores(pool: Pool, place: int, sought: Sequence[Direction]) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Information (D, D) and score (D,) of each direction in one recording, and which it shows (D,)."""
    one, known = pool.recordings[place], _reduced(pool, place, shared=True)
    information, slope = known.solved()
    columns = np.stack([_column(one, one.roots[pool.share], direction) for direction in sought], axis=1)
    cross = known.root.T @ columns
    absorbed = np.linalg.solve(information, np.concatenate([cross, slope[:, None]], axis=1))
    whole = columns.T @ columns
    own = whole - cross.T @ absorbed[:, :-1]
    score = -columns.T @ known.residual - cross.T @ absorbed[:, -1]
    return own, score, np.diag(own) > np.maximum(VISIBLE**2 * one.data, 1e-6 * np.diag(whole))


def _strengths(pool: Pool, place: int, sought: Sequence[Direction]) -> tuple[Array, Array]:
    """Estimate and standard deviation (D,) of each direction in one recording."""
    information, score, visible = _scores(pool, place, sought)
    safe = np.where(visible, np.diag(information), 1.0)
    return np.where(visible, score / safe, 0.0), np.where(visible, 1.0 / np.sqrt(safe), np.inf)


def strengths_where(pool: Pool, acting: KnownEffect) -> dict[str, tuple[float, float, float]]:
    """The effect's strengths with their intervals (95 %), over the recordings in which it acts.

    A single strength is that of its presence. Of two, both are estimated together; their deviations are enlarged as
    the presence's own exceeds what these recordings state along its direction: by how much the strength varies.
    """
    direction, there = acting.direction, acting.presence
    nominal = {s.name: s.nominal for s in catalogue()[direction.effect].strengths}
    single = [Direction(direction.effect, (column,), (1.0,)) for column in direction.columns]
    values, deviations = np.array([there.strength]), np.array([there.deviation])
    if len(single) > 1:
        parts = [_scores(pool, place, single) for place in range(len(pool.recordings))]
        both = zip(there.acts, parts, strict=True)
        information = sum((p * own for p, (own, _, _) in both), np.zeros((len(single), len(single))))
        score = sum((p * own for p, (_, own, _) in zip(there.acts, parts, strict=True)), np.zeros(len(single)))
        covariance, along = np.linalg.pinv(information, hermitian=True), np.array(direction.weights)
        stated = 1.0 / np.sqrt(along @ information @ along)
        values = covariance @ score
        deviations = np.sqrt(np.diag(covariance)) * max(there.deviation / stated, 1.0)
    found = {}
    for column, value, deviation in zip(direction.columns, values, deviations, strict=True):
        size, reach = nominal[column[1]] * float(value), 1.96 * nominal[column[1]] * float(deviation)
        found[column[1]] = (size, size - reach, size + reach)
    return found


def _parameters(pool: Pool, place: int) -> dict[ParameterName, tuple[float, float]]:
    """Value and standard deviation of each base parameter from this recording alone."""
    one, known = pool.recordings[place], _reduced(pool, place, shared=False)
    information, slope = known.solved()
    count = len(one.free)
    size = np.sqrt(np.maximum(np.diag(information), 1e-30))
    inverse = np.linalg.pinv(information / np.outer(size, size), hermitian=True) / np.outer(size, size)
    moved = inverse @ slope
    return {
        name: (one.centre[k] + one.scale[k] * moved[k], one.scale[k] * float(np.sqrt(inverse[k, k])))
        for k, name in enumerate(one.free[:count])
    }


def unit_of(effect: str, parameter: str) -> str:
    """The unit of a parameter of the catalogue, "" where it is none of it (a declared number)."""
    rows = ((row.effect, row.parameter) for row in parameter_rows())
    return next((one.unit for name, one in rows if (name, one.name) == (effect, parameter)), "")
