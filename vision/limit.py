"""The Cramer-Rao limit of a shape seen by its edges: what no unbiased method can better."""

from __future__ import annotations

import numpy as np

from tentacle.signals import Array

EDGE = 1.88  # px of edge error per (noise / contrast), at 1 px of blur; grows with the root of the blur


def edge_sigma(noise: float, contrast: float, blur: float = 1.0) -> float:
    """Least standard deviation of one row's edge [px], by the Fisher information of a normally blurred step.

    With pixels 1 px apart, var = noise^2 / sum (d grey / d place)^2, and the sum is contrast^2 / (2 sqrt(pi) blur).
    noise, contrast [grey]; blur [px].
    """
    return float(noise / contrast * np.sqrt(2.0 * np.sqrt(np.pi) * blur))


def straight_arm_limit(order: int, sigma_e: float, length_px: float, offset_known: bool = True) -> Array:
    """Least covariance (K, K) [rad^2] of [offset, q1 .. qn] of a straight arm, or of q alone where the offset is known.

    One row per px of length, two edges a row, each with error sigma_e [px]. For two coordinates this is
    sqrt(720) sigma_e/(L sqrt(2N)) and sqrt(9072) sigma_e/(L sqrt(2N)).
    """
    s = (np.arange(int(length_px)) + 0.5) / int(length_px)
    # a straight arm's centre moves sideways by L int_0^s phi dv
    columns = [s] + [s ** (j + 1) / (j * (j + 1)) for j in range(1, order + 1)]
    design = length_px * np.array(columns[1:] if offset_known else columns).T
    return np.asarray(np.linalg.inv(2.0 * design.T @ design) * sigma_e**2, dtype=float)


def shape_limit(q: Array, angle: float, sigma_e: float, length_px: float) -> Array:
    """Least covariance (n, n) of q [rad^2] of a bent arm, whose base angle [rad] and base are known; else as above."""
    s = (np.arange(int(length_px)) + 0.5) / int(length_px)
    powers = np.array([s ** (j + 1) / (j + 1) for j in range(len(q))])
    phi = angle + q @ powers
    normal = np.array([np.cos(phi), np.sin(phi)])
    turned = -powers[:, None] * normal  # d tangent / dq, along s
    moved = np.cumsum(turned, axis=2) - 0.5 * turned
    design = np.sum(moved * normal, axis=1).T * length_px / len(s)
    return np.asarray(np.linalg.inv(2.0 * design.T @ design) * sigma_e**2, dtype=float)
