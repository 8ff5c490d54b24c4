"""The missing force laid along the arm: the smoothest normal line force that does what the coordinates lack.

f(s) ~ Gaussian process over REACH arm lengths,   Q_j = L int (dr/dz_j . n) f ds + error,   f given Q: Gaussian
"""

from __future__ import annotations

import numpy as np

from affine_model.arm import Arm
from affine_model.curvature import Array
from inference.latent_force import REACH
from inference.missing_force import SeenMotion
from tentacle.proposed_law import ForceMap

TIMES = 400  # of the map, at most
PLACES = 25


def force_map(name: str, arm: Arm, motion: SeenMotion) -> ForceMap:
    """The normal force [N/m] along the arm and in time, with its standard deviation, of one recording."""
    n, L, rule = arm.order, arm.specimen.length, arm.rule
    keep = np.linspace(0, motion.t.size - 1, min(TIMES, motion.t.size)).astype(int)
    phi = motion.u[keep, n : n + 1] + motion.u[keep, :n] @ arm.angle_basis.T
    normal = np.stack([np.cos(phi), np.sin(phi)], -1)
    levers = np.einsum("ik,tkx,kj->tixj", L * rule.integration, -normal, arm.angle_basis)
    across = np.einsum("tixj,tix->tji", levers, normal) * (L * rule.weights)  # (T, n, N)
    s = np.linspace(0.0, 1.0, PLACES)
    alike = np.exp(-0.5 * ((rule.s[:, None] - rule.s) / REACH) ** 2)
    shown = np.exp(-0.5 * ((s[:, None] - rule.s) / REACH) ** 2)
    per_unit = np.einsum("tji,ik,tlk->tjl", across, alike, across)
    force, spread = motion.force[keep], motion.spread[keep]
    size = float(np.mean(force**2) / max(np.mean(np.einsum("tjj->tj", per_unit)), 1e-300))
    covariance = size * per_unit + np.einsum("tj,jl->tjl", spread**2, np.eye(n))
    gain = size * np.einsum("pi,tji,tjl->tpl", shown, across, np.linalg.inv(covariance))
    mean = np.einsum("tpl,tl->tp", gain, force)
    left = size * (1.0 - np.einsum("tpl,tli,pi->tp", gain, across, shown))
    return ForceMap(name, motion.t[keep], s, mean, np.sqrt(np.maximum(left, 0.0)))


def rms_along(shown: ForceMap) -> Array:
    """rms over time of the force at each place [N/m]."""
    return np.sqrt(np.mean(shown.force**2, axis=0))
