"""The look of an arm's edges: properties that are the same in all frames."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tentacle.signals import Array

KNOTS = 8  # stretches of the arm with their own usual contrast
MANY = 10  # fewest edges for a stretch's contrast
FAINTEST = 0.2  # of the arm's contrast: the smallest contrast of a stretch


@dataclass(frozen=True)
class EdgeLook:
    """Properties of edges that are the same in all frames. blur [px], polarity (+1 dark arm), contrast [grey]. along
    (KNOTS,): contrast from base to tip, as shares of contrast; a thin tip lets light through.

    wider (width.KNOTS,) [px]: usual excess of the arm's width over the fitted one (width.usual_widths).
    """

    blur: float
    polarity: float
    contrast: float
    along: tuple[float, ...] = (1.0,) * KNOTS
    wider: tuple[float, ...] | None = None

    def contrast_at(self, s: Array) -> Array:
        """The usual contrast (E,) [grey] of edges at s (E,)."""
        return self.contrast * np.interp(s, (np.arange(KNOTS) + 0.5) / KNOTS, self.along)


def contrast_along(s: Array, contrast: Array) -> tuple[float, ...]:
    """EdgeLook.along as side edges at s (N,) show it, contrast (N,) [grey] as the arm's polarity has it.

    Medians over stretches of the arm, where a stretch is fainter than the arm.
    """
    there = contrast > 0.0
    s, contrast = s[there], contrast[there]
    usual = float(np.median(contrast)) if len(contrast) else 1.0
    parts = [contrast[(s >= k / KNOTS) & (s < (k + 1.0) / KNOTS)] for k in range(KNOTS)]
    shares = [float(np.median(part)) / usual if len(part) >= MANY else 1.0 for part in parts]
    return tuple(float(np.clip(share, FAINTEST, 1.0)) for share in shares)
