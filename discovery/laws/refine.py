"""The shapes of a form refined: where its strengths are what the data want, the shapes that explain the most.

    least over x of min over a of |t - S(x) a|^2,     by Gauss and Newton on (1 - P) (dS/dx a), P the projector on S

(variable projection; Golub and Pereyra 1973, Kaufman 1975), damped as by Marquardt, from several starts at once.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from tentacle.signals import Array

ROUNDS = 14
DIFFERENCE = 2e-3  # grid spacings, of slopes
FARTHEST = 1.5  # grid spacings of one step
ENOUGH = 0.02  # nats that a round must gain to go on
SOFTER, STIFFER, FIRST_DAMPING = 0.2, 6.0, 1e-2
UNKNOWN = 1e3  # grid spacings: standard deviations are no larger


@dataclass(frozen=True)
class RefinementStart:
    """Shapes (P,) to start from, and |t|^2 less what their law leaves."""

    shapes: Array
    explained: float


@dataclass
class _Walk:
    """Where one start has come to: shapes in grid spacings, what they explain, and the slopes there."""

    x: Array
    explained: float = -np.inf
    normal: Array | None = None
    slope: Array | None = None
    damping: float = FIRST_DAMPING
    done: bool = False

    def next(self, low: Array, high: Array) -> Array:
        """The next shapes to be tried."""
        if self.normal is None or self.slope is None:
            return self.x
        free = ~((self.x <= low) & (self.slope < 0.0) | (self.x >= high) & (self.slope > 0.0))
        step = np.zeros_like(self.x)
        matrix = self.normal[np.ix_(free, free)]
        matrix = matrix + np.diag(self.damping * np.diag(matrix) + 1e-9 * (np.trace(matrix) + 1e-300))
        step[free] = np.linalg.solve(matrix, self.slope[free])
        step *= min(1.0, FARTHEST / max(float(np.abs(step).max(initial=0.0)), 1e-300))
        return np.clip(self.x + step, low, high)


@dataclass(frozen=True)
class RefinementProblem:
    """What is refined. answers: shapes (B, P) -> answers (rows, B strengths) of unit strengths; target (rows,); bounds
    (P, 2) and grid spacing (P,) of the shapes; strength_bounds (strengths, 2).
    """

    answers: Callable[[Array], Array]
    target: Array
    bounds: Array
    spacing: Array
    strength_bounds: Array


def refined_shapes(starts: list[RefinementStart], asked: RefinementProblem) -> tuple[Array, Array]:
    """The best shapes (P,) from any start, and their standard deviations if the law is true (noise of variance 1)."""
    bounds, spacing, target = asked.bounds, asked.spacing, asked.target
    low, high = (bounds / spacing[:, None]).T
    walks = [_Walk(start.shapes / spacing) for start in starts]
    count = spacing.size
    for _ in range(ROUNDS):
        going = [walk for walk in walks if not walk.done]
        if not going:
            break
        tried = [walk.next(low, high) for walk in going]
        ways = [np.where(x + DIFFERENCE > high, -DIFFERENCE, DIFFERENCE) for x in tried]
        trials = np.concatenate([
            np.vstack([x, x + way[:, None] * np.eye(count)]) for x, way in zip(tried, ways, strict=True)
        ])  # fmt: skip
        columns = asked.answers(trials * spacing)
        parts = columns.reshape(target.size, len(going), count + 1, -1)
        for k, walk in enumerate(going):
            _judge(walk, (tried[k], ways[k]), parts[:, k], asked)
    best = max(walks, key=lambda walk: walk.explained)
    if best.normal is None:  # no start has strengths within their bounds
        return starts[0].shapes, UNKNOWN * spacing
    spread = np.sqrt(np.diag(np.linalg.inv(best.normal + UNKNOWN**-2 * np.eye(count))))
    return np.clip(best.x * spacing, *bounds.T), spread * spacing  # the rounding of x * spacing may pass a bound


def _judge(walk: _Walk, tried: tuple[Array, Array], part: Array, asked: RefinementProblem) -> None:
    """Go to x where it explains more; tried: x, and how far each neighbour is; part (rows, 1 + P, strengths): the
    answers there and at the neighbours.
    """
    (x, way), target = tried, asked.target
    basis, triangle = np.linalg.qr(part[:, 0])
    at = basis.T @ target
    explained = float(at @ at)
    strengths = np.linalg.lstsq(triangle, at, rcond=1e-12)[0]
    low, high = asked.strength_bounds.T
    within = np.isfinite(explained) and bool(np.all((strengths >= low) & (strengths <= high)))
    if not within or explained <= walk.explained:
        walk.damping *= STIFFER
        walk.done = walk.damping > 1e6
        return
    slopes = (part[:, 1:] - part[:, :1]) @ strengths / way
    slopes = slopes - basis @ (basis.T @ slopes)
    left = target - basis @ at
    walk.done = explained - walk.explained < 2.0 * ENOUGH
    walk.x, walk.explained, walk.damping = x, explained, walk.damping * SOFTER
    walk.normal, walk.slope = slopes.T @ slopes, slopes.T @ left
