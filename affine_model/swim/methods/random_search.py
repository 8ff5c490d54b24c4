"""Uniform random points, the method with which all others are compared."""

from __future__ import annotations

import numpy as np

from affine_model.curvature import Array
from tentacle.gait import GAIT_PARAMETERS


class RandomSearch:
    """Batches of `population` points, uniform in the unit cube."""

    def __init__(self, seed: int, population: int = 50) -> None:
        self._random = np.random.default_rng(seed)
        self._population = population

    def ask(self) -> Array:
        """The next points (9, B)."""
        return self._random.random((GAIT_PARAMETERS, self._population))

    def tell(self, unit: Array, scores: Array) -> None:
        """Nothing is learnt."""
