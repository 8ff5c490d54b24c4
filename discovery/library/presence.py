"""In which recordings of a library an effect acts: a two-state Markov chain over the recordings, in time order.

    g_r | z_r ~ N(b + z_r c_r, s_r^2 (1 + f (T_r - 1))),     c_r ~ N(c, (v c)^2), of the sign of c
    P(z_1 = 1) = p,     P(z_r = 1 | z_(r-1)) = p + k (z_(r-1) - p)

g_r, s_r: the estimate of recording r alone with its standard deviation; z_r: whether the effect acts there. c: its
strength, under the prior of a diagnosis (Cauchy of the nominal size); v: how much it varies. p: in which share of the
recordings; k: how much longer it stays than by chance (k = 0: recordings are independent).

A single diagnosis coarsens its evidence by T_r, since errors of the declared model may look like an effect. In a
library a share 1 - f of their variance is the same in all recordings: the offset b, N(0, (1 - f) mean (T_r - 1) s_r^2),
which the recordings without the effect show. The rest differs between recordings. f, p, k, v, c and b are summed over,
so that the library itself says how much its recordings differ without any effect. Sources: Hamilton 1989 (the chain);
Efron 2004 (the null distribution as the many recordings without an effect show it).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import log_ndtr

from tentacle.compiled import njit
from tentacle.signals import Array

SHARES_PRESENT = np.array([0.03, 0.1, 0.3, 0.7, 0.97])  # p
PERSISTENCE = np.array([0.0, 0.7, 0.95])  # k
VARIES = np.array([0.1, 0.4])  # v
DIFFERS = np.array([0.0, 0.1, 1.0])  # f
STRENGTHS, RANGE = 18, (0.3, 1.3)  # of each sign; from .3 of an estimate's standard deviation to 1.3 of the largest one
OFFSETS = 21  # quantiles of the estimates at which b is summed over
MOST_ODDS, LOGS_AFTER = 40.0, 7  # nats of one recording; products of so many odds fit into a float
NEGLIGIBLE = 9.0  # nats: what lies further behind the best holds 1e-4 of it


@dataclass(frozen=True)
class Estimates:
    """Of one effect's strength: values and deviations (R,), in time order, inf where a recording does not show it;
    coarsening (R,); nominal size, and whether it has a sign.
    """

    values: Array
    deviations: Array
    coarsening: Array
    nominal: float
    one_sided: bool


@dataclass(frozen=True)
class Presence:
    """evidence [nats]: of the effect acting in some recordings over its acting in none. Given that it acts in some:
    acts (R,), the probability that it acts there; strength with its standard deviation; varies, v.
    """

    evidence: float
    acts: Array
    strength: float
    deviation: float
    varies: float


@dataclass(frozen=True)
class _Grid:
    """Points (G,) of the sum: offset b, strength c, v, and f, with their log weights; the chain's are apart."""

    offset: Array
    strength: Array
    varies: Array
    differs: Array
    log_weight: Array


def presence(estimates: Estimates) -> Presence:
    """Where an effect acts, from each recording's own estimate of its strength."""
    known = np.isfinite(estimates.deviations)
    if not known.any():
        return Presence(0.0, np.zeros(known.size), 0.0, np.inf, 0.0)
    grid = _grid(estimates, known)
    absent, odds = _log_densities(estimates, known, grid)
    p, k = (one.ravel() for one in np.meshgrid(SHARES_PRESENT, PERSISTENCE))
    without = absent + grid.log_weight
    with_it = _chains(odds, p, k, LOGS_AFTER) + without - np.log(p.size)  # (chains, G)
    none = float(np.logaddexp.reduce(without))
    total = float(np.logaddexp.reduce(with_it.ravel()))
    mass = np.exp(with_it - total)
    acts = np.zeros(known.size)
    for place in range(p.size):
        live = with_it[place] > with_it.max() - NEGLIGIBLE
        if live.any():
            acts += mass[place, live] @ _smoothed(odds[:, live], float(p[place]), float(k[place]))
    acts /= mass[with_it > with_it.max() - NEGLIGIBLE].sum()
    own = mass.sum(axis=0)
    strength = float(own @ grid.strength)
    deviation = float(np.sqrt(own @ (grid.strength - strength) ** 2))
    return Presence(total - none, acts, strength, deviation, float(own @ grid.varies))


def _grid(estimates: Estimates, known: np.ndarray) -> _Grid:
    values, deviations = estimates.values[known], estimates.deviations[known]
    extra = np.maximum(estimates.coarsening[known] - 1.0, 0.0) * deviations**2
    shared = float(np.sqrt(np.mean(extra)))
    usual = float(np.median(deviations))
    low, high = np.log(RANGE[0] * usual), np.log(max(RANGE[1] * np.abs(values).max(), usual))
    sizes = np.exp(np.linspace(low, high, STRENGTHS))
    strengths = sizes if estimates.one_sided else np.concatenate([-sizes[::-1], sizes])
    prior = np.log(sizes) - np.log1p((sizes / estimates.nominal) ** 2)  # Cauchy on a logarithmic grid
    prior = prior + np.log(2.0 * (high - low) / (STRENGTHS - 1) / (np.pi * estimates.nominal))
    prior = prior if estimates.one_sided else np.concatenate([prior[::-1], prior]) - np.log(2.0)
    offsets, between = np.zeros(1), np.zeros(1)
    if shared > 0.05 * usual and values.size > 2:
        levels = np.linspace(0.0, 1.0, OFFSETS + 2)[1:-1]
        offsets = np.quantile(values, levels)
        between = np.log(np.maximum(np.gradient(offsets), 1e-300))
    places = np.meshgrid(range(offsets.size), range(strengths.size), range(2), range(DIFFERS.size), indexing="ij")
    b, c, v, f = (place.ravel() for place in places)
    assert VARIES.size == 2
    weight = prior[c] - np.log(VARIES.size * DIFFERS.size)
    if offsets.size > 1:
        wide = np.maximum(shared * np.sqrt(1.0 - DIFFERS[f]), 0.05 * usual)
        weight = weight + between[b] - 0.5 * (offsets[b] / wide) ** 2 - np.log(np.sqrt(2.0 * np.pi) * wide)
    return _Grid(offsets[b], strengths[c], VARIES[v], DIFFERS[f], weight)


def _log_densities(estimates: Estimates, known: np.ndarray, grid: _Grid) -> tuple[Array, Array]:
    """Log density (G,) of all estimates without the effect, and the odds (R, G) of each with it to without it; 1 where
    a recording shows nothing.
    """
    values, coarsening = estimates.values[known, None], np.maximum(estimates.coarsening[known, None], 1.0)
    variance = estimates.deviations[known, None] ** 2 * (1.0 + grid.differs * (coarsening - 1.0))
    away = values - grid.offset
    absent = -0.5 * (away**2 / variance + np.log(variance))
    wider = variance + (grid.varies * grid.strength) ** 2
    present = -0.5 * ((away - grid.strength) ** 2 / wider + np.log(wider))
    # The share of c_r that has the sign of c, after and before its estimate.
    between = (grid.varies * grid.strength) ** 2
    middle = (grid.strength * variance + away * between) / wider * np.sign(grid.strength)
    present += log_ndtr(middle / np.sqrt(variance * between / wider)) - log_ndtr(1.0 / grid.varies)
    odds = np.ones((known.size, grid.offset.size))
    odds[known] = np.exp(np.clip(present - absent, -MOST_ODDS, MOST_ODDS))
    return absent.sum(axis=0), odds


@njit(cache=True, nogil=True)
def _chains(odds, p, k, logs_after):
    """Log evidence (M, G) of M chains with p, k (M,) over that of no effect anywhere; odds (R, G)."""
    count, points = odds.shape
    total = np.zeros((p.size, points))
    for m in range(p.size):
        for g in range(points):
            acts, product = p[m], 1.0
            for r in range(count):
                ahead = p[m] + k[m] * (acts - p[m])
                one = ahead * odds[r, g]
                both = one + 1.0 - ahead
                acts = one / both
                product *= both
                if r % logs_after == logs_after - 1:
                    total[m, g] += np.log(product)
                    product = 1.0
            total[m, g] += np.log(product)
    return total


def _filtered(odds: Array, p: float, k: float) -> Array:
    """Probability (R, G) that the effect acts in each recording, from those up to it."""
    acts, filtered = np.full(odds.shape[1], p), np.empty_like(odds)
    for r, own in enumerate(odds):
        ahead = p + k * (acts - p)
        acts = ahead * own / (ahead * own + 1.0 - ahead)
        filtered[r] = acts
    return filtered


def _smoothed(odds: Array, p: float, k: float) -> Array:
    """Probability (G, R) that the effect acts in each recording, given all of them."""
    smooth = _filtered(odds, p, k)
    stays = p + k * (1.0 - p)
    for r in range(odds.shape[0] - 2, -1, -1):
        ahead = np.clip(p + k * (smooth[r] - p), 1e-300, 1.0 - 1e-16)
        acts = smooth[r + 1]
        smooth[r] *= acts * stays / ahead + (1.0 - acts) * (1.0 - stays) / (1.0 - ahead)
    return smooth.T
