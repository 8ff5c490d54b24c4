"""The missing force as a smooth normal force along the arm and a normal force at the tip.

Many such forces give the same generalised force. The posterior mean under these priors is shown:

    f(s) ~ Gaussian process over FORCE_CORRELATION_LENGTH,  F ~ Gaussian,
    Q_j = L int (dr/dz_j . n) f ds + (dr/dz_j . n)(1) F + error,         f and F given Q: Gaussian
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from affine_model.arm import Arm
from inference.missing_force import SeenMotion
from tentacle.proposed_law import ForceMap

FORCE_MAP_TIMES = 3000  # of the map, at most
FORCE_MAP_PLACES = 25
FORCE_CORRELATION_LENGTH = 0.15  # arm lengths: correlation length of the force that is shown


def shown_instants(motion: SeenMotion) -> NDArray[np.intp]:
    """Indices of the instants at which a missing force is placed: evenly among those that are seen, FORCE_MAP_TIMES at
    most.
    """
    return _evenly(np.flatnonzero(motion.seen))


def _evenly(among: NDArray[np.intp]) -> NDArray[np.intp]:
    return among[np.linspace(0, among.size - 1, min(FORCE_MAP_TIMES, among.size)).astype(np.intp)]


def force_map(name: str, arm: Arm, motion: SeenMotion) -> ForceMap:
    """The normal force along the arm [N/m] and at the tip [N], with their standard deviations, of one recording; NaN
    where the motion is not seen.
    """
    n, L, rule = arm.order, arm.specimen.length, arm.rule
    keep = _evenly(np.arange(motion.t.size))
    u = motion.u[keep]
    phi = u[:, n : n + 1] + u[:, :n] @ arm.angle_basis.T
    end = u[:, n] + u[:, :n] @ arm.angles_at([1.0])[0]
    normal = np.stack([np.cos(phi), np.sin(phi)], -1)
    levers = np.einsum("ik,tkx,kj->tixj", L * rule.integration, -normal, arm.angle_basis)
    tip_levers = np.einsum("k,tkx,kj->txj", L * rule.weights, -normal, arm.angle_basis)
    across = np.einsum("tixj,tix->tji", levers, normal) * (L * rule.weights)  # (T, n, N)
    at_tip = np.einsum("txj,tx->tj", tip_levers, np.stack([np.cos(end), np.sin(end)], -1))
    s = np.linspace(0.0, 1.0, FORCE_MAP_PLACES)
    alike = np.exp(-0.5 * ((rule.s[:, None] - rule.s) / FORCE_CORRELATION_LENGTH) ** 2)
    shown = np.exp(-0.5 * ((s[:, None] - rule.s) / FORCE_CORRELATION_LENGTH) ** 2)
    by_line = np.einsum("tji,ik,tlk->tjl", across, alike, across)
    by_tip = np.einsum("tj,tl->tjl", at_tip, at_tip)
    force, spread = motion.force[keep], motion.spread[keep]
    unseen = ~motion.seen[keep]
    power = float(np.mean(force[~unseen] ** 2))
    # Each part alone is as large as the missing generalised force.
    line, tip = (power / max(float(np.mean(np.einsum("tjj->tj", part))), 1e-300) for part in (by_line, by_tip))
    covariance = line * by_line + tip * by_tip + np.einsum("tj,jl->tjl", spread**2, np.eye(n))
    inverse = np.linalg.inv(covariance)
    cross = line * np.einsum("pi,tji->tpj", shown, across)
    gain, tip_gain = np.einsum("tpj,tjl->tpl", cross, inverse), tip * np.einsum("tj,tjl->tl", at_tip, inverse)
    left = line - np.einsum("tpl,tpl->tp", gain, cross)
    tip_left = tip - tip * np.einsum("tl,tl->t", tip_gain, at_tip)
    made = (
        np.einsum("tpl,tl->tp", gain, force), np.sqrt(np.maximum(left, 0.0)),
        np.einsum("tl,tl->t", tip_gain, force), np.sqrt(np.maximum(tip_left, 0.0)),
    )  # fmt: skip
    for part in made:
        part[unseen] = np.nan
    return ForceMap(name, motion.t[keep], s, *made)
