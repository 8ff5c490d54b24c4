"""How far the errors of an arm's edges are from independent ones, told by their slow waves along the arm."""

from __future__ import annotations

import numpy as np

from tentacle.signals import Array


def inflation(waves: Array) -> tuple[float, float]:
    """Factors on the variance of q, and further on that of the shared parameters, over that for independent edges.

    Both are at least 1 and come from waves (T, W), FrameFit.waves of T frames: their power over all frames, and the
    share of it that persists from frame to frame (a bubble on the arm, a mirror image), times T, because it does not
    average out.
    """
    power = float(np.mean(waves**2))
    staying = len(waves) * float(np.mean(waves.mean(axis=0) ** 2)) / max(power, 1e-12)
    return max(power, 1.0), max(staying, 1.0)
