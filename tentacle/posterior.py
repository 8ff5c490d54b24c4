"""What a fit knows of several parameters together: the joint normal around its estimates.

parameters ~ N(estimates, D R D),   D = diag(deviation),   R = correlation
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_ROUNDING = 1e-6  # of a correlation: what text and inversion may leave


@dataclass(frozen=True)
class Posterior:
    """names (F,) "effect.parameter"; deviation (F,) in the parameters' units; correlation (F, F).

    Raises ValueError where the sizes differ, a deviation is not positive, or the matrix is no correlation.
    """

    names: tuple[str, ...]
    deviation: tuple[float, ...]
    correlation: tuple[tuple[float, ...], ...]

    def __post_init__(self) -> None:
        count = len(self.names)
        if not count or len(set(self.names)) < count or len(self.deviation) != count or len(self.correlation) != count:
            raise ValueError("names, deviation and correlation differ in number, or a name stands twice")
        if any(len(row) != count for row in self.correlation):
            raise ValueError("correlation is not square")
        matrix = np.array(self.correlation)
        if not (np.isfinite(self.deviation).all() and min(self.deviation) > 0.0):
            raise ValueError("a deviation is not positive")
        if not np.isfinite(matrix).all() or np.abs(matrix - matrix.T).max() > _ROUNDING:
            raise ValueError("correlation is not symmetric")
        if np.abs(np.diag(matrix) - 1.0).max() > _ROUNDING or np.linalg.eigvalsh(matrix)[0] < -_ROUNDING:
            raise ValueError("correlation is no correlation matrix")

    @staticmethod
    def of_covariance(names: tuple[str, ...], covariance: NDArray[np.float64]) -> Posterior | None:
        """From a covariance (F, F); None where no parameter has a variance. Those without one are left out."""
        spread = np.sqrt(np.maximum(np.diag(covariance), 0.0))
        kept = np.flatnonzero(np.isfinite(spread) & (spread > 0.0))
        if not kept.size:
            return None
        matrix = covariance[np.ix_(kept, kept)] / np.outer(spread[kept], spread[kept])
        values, vectors = np.linalg.eigh(0.5 * (matrix + matrix.T))
        matrix = (vectors * np.maximum(values, 0.0)) @ vectors.T  # an ill fit's inverse may round below zero
        matrix = matrix / np.sqrt(np.outer(np.diag(matrix), np.diag(matrix)))
        rows = tuple(tuple(row) for row in (0.5 * (matrix + matrix.T)).tolist())
        return Posterior(tuple(names[k] for k in kept), tuple(spread[kept].tolist()), rows)

    def of(self, names: Collection[str]) -> Posterior | None:
        """That of these parameters alone, all others marginalised; None where it has none of them."""
        kept = [place for place, name in enumerate(self.names) if name in names]
        if not kept:
            return None
        rows = tuple(tuple(self.correlation[i][j] for j in kept) for i in kept)
        return Posterior(tuple(self.names[k] for k in kept), tuple(self.deviation[k] for k in kept), rows)

    def draws(self, count: int, random: np.random.Generator) -> NDArray[np.float64]:
        """Departures (F, count) from the estimates."""
        values, vectors = np.linalg.eigh(np.array(self.correlation))
        root = vectors * np.sqrt(np.maximum(values, 0.0))
        return np.array(self.deviation)[:, None] * (root @ random.standard_normal((len(self.names), count)))
