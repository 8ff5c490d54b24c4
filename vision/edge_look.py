"""The look of an arm's edges: properties that are the same in all frames."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tentacle.signals import Array

KNOTS = 12  # stretches of the arm with their own usual contrast
MANY = 10  # fewest edges for a stretch's contrast
FAINTEST = 0.2  # of the arm's contrast: the smallest contrast of a stretch
PLAIN_BODY = 0.8  # least share of the largest: a body without a fainter stretch has one grey


@dataclass(frozen=True)
class EdgeLook:
    """Properties of edges that are the same in all frames. blur [px], polarity (+1 dark arm), contrast [grey]. along
    (KNOTS,): contrast from base to tip, as shares of contrast; a thin tip lets light through.

    fade (KNOTS,): the course of the body's own share of the light, uneven light taken off; 1 for a body of one grey.
    wider (width.KNOTS,) [px]: usual excess of the arm's width over the fitted one (width.usual_widths).
    """

    blur: float
    polarity: float
    contrast: float
    along: tuple[float, ...] = (1.0,) * KNOTS
    fade: tuple[float, ...] = (1.0,) * KNOTS
    wider: tuple[float, ...] | None = None

    def contrast_at(self, s: Array) -> Array:
        """The usual contrast (E,) [grey] of edges at s (E,)."""
        return self.contrast * _course(s, self.along)

    def fade_at(self, s: Array) -> Array:
        """The body's fade (E,) at s (E,)."""
        return np.ones(len(s)) if min(self.fade) == 1.0 else _course(s, self.fade)


def _course(s: Array, knots: tuple[float, ...]) -> Array:
    """A course (E,) at s (E,) from its values at the stretches' middles, extrapolated to the tip."""
    at = (np.arange(KNOTS) + 0.5) / KNOTS
    beyond = knots[-1] + (knots[-1] - knots[-2]) * (1.0 - at[-1]) / (at[-1] - at[-2])
    return np.interp(s, [*at, 1.0], [*knots, min(max(beyond, FAINTEST), 1.0)])


def seen_along(sight: EdgeLook, s: Array, contrast: Array, light: Array) -> EdgeLook:
    """The look with the course along the arm of side edges at s (N,): their contrast (N,), light (N,) beside them."""
    dark = contrast * sight.polarity
    fade = contrast_along(s, dark / np.maximum(light, 1.0))
    plain = min(fade) >= PLAIN_BODY * max(fade)
    return replace(sight, along=contrast_along(s, dark), fade=(1.0,) * KNOTS if plain else fade)


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
