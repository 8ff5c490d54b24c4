"""The Cramer-Rao limit of a shape seen by its edges, by one row per px of length and two edges a row."""

from __future__ import annotations

import numpy as np

from tentacle.signals import Array


def edge_sigma(noise: float, contrast: float, blur: float = 1.0) -> float:
    """Least standard deviation of one row's edge [px], by the Fisher information of a normally blurred step.

    With pixels 1 px apart, var = noise^2 / sum (d grey / d place)^2, and the sum is contrast^2 / (2 sqrt(pi) blur).
    noise, contrast [grey]; blur [px].
    """
    return float(noise / contrast * np.sqrt(2.0 * np.sqrt(np.pi) * blur))


def shape_limit(q: Array, angle: float, sigma_e: float, length_px: float) -> Array:
    """Least covariance (n, n) of q [rad^2] of a bent arm, whose base angle [rad] and base are known; each edge errs by
    sigma_e [px]."""
    s = (np.arange(int(length_px)) + 0.5) / int(length_px)
    powers = np.array([s ** (j + 1) / (j + 1) for j in range(len(q))])
    phi = angle + q @ powers
    normal = np.array([np.cos(phi), np.sin(phi)])
    turned = -powers[:, None] * normal  # d tangent / dq, along s
    moved = np.cumsum(turned, axis=2) - 0.5 * turned
    design = np.sum(moved * normal, axis=1).T * length_px / len(s)
    return np.asarray(np.linalg.inv(2.0 * design.T @ design) * sigma_e**2, dtype=float)
