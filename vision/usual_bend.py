"""Prior knowledge of an arm's shape: strong and rapidly changing curvature is unlikely.

x' R x = integral over s of (curvature / BEND)^2 + (its slope / BEND_CHANGE)^2, curvature = sum_j q_j s^(j - 1).
"""

from __future__ import annotations

import numpy as np

from tentacle.signals import Array

BEND, BEND_CHANGE = 20.0, 60.0  # rad: rms of an arm's curvature along it, and of the curvature's slope, at most


def usual_bend(x: Array, error: float) -> tuple[Array, Array]:
    """error^2 R (K, K) and -error^2 R x (K,) at a shape x (K,), beside edges that err by error [px].

    It is negligible where there are edges, and decides where there are none.
    """
    power = np.arange(len(x)) - 1.0
    both = power[1:, None] + power[1:]
    square = 1.0 / ((both + 1.0) * BEND**2)
    square += power[1:, None] * power[1:] / (np.maximum(both - 1.0, 1.0) * BEND_CHANGE**2)
    information = np.zeros((len(x), len(x)))
    information[1:, 1:] = error**2 * square
    return information, -information @ x
