"""The paper's evolutionary algorithm: population 50, mutation rate 0.02 (100 generations make its 5000 evaluations).

The paper names Matlab's Global Optimization Toolbox and these numbers only. All else follows the defaults of that
toolbox's `ga` for bounded problems: rank scaling 1/sqrt(rank), stochastic universal selection, 5 % elite, 80 % of the
others by scattered crossover, the rest by mutation. The mutation rate can be read in two ways, and both are here: each
gene of a mutant redrawn with that probability (the toolbox's uniform mutation; `ga`), or each individual with that
probability, in one gene (`ga-individual`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from affine_model.curvature import Array
from tentacle.gait import GAIT_PARAMETERS


class GeneticAlgorithm:
    """Batches are generations of `population` individuals; genes lie in [0, 1]. by_individual: see above."""

    def __init__(self, seed: int, population: int = 50, mutation: float = 0.02, *, by_individual: bool = False) -> None:
        self._random = np.random.default_rng(seed)
        self._mutation, self._by_individual = mutation, by_individual
        self._elite = int(np.ceil(0.05 * population))
        self._crossed = round(0.8 * (population - self._elite))
        self._generation = self._random.random((GAIT_PARAMETERS, population))

    def ask(self) -> Array:
        """The present generation (9, B)."""
        return self._generation

    def tell(self, unit: Array, scores: Array) -> None:
        """Breed the next generation."""
        count = unit.shape[1]
        ranked = unit[:, np.argsort(-scores, kind="stable")]
        fitness = 1.0 / np.sqrt(np.arange(1, count + 1))
        mutated = count - self._elite - self._crossed
        chosen = self._select(fitness, 2 * self._crossed + mutated)
        first, second = ranked[:, chosen[: self._crossed]], ranked[:, chosen[self._crossed : 2 * self._crossed]]
        crossed = np.where(self._random.random(first.shape) < 0.5, first, second)
        mutants = ranked[:, chosen[2 * self._crossed :]]
        mutants = np.where(self._redrawn(mutants.shape), self._random.random(mutants.shape), mutants)
        self._generation = np.concatenate([ranked[:, : self._elite], crossed, mutants], axis=1)

    def _redrawn(self, shape: tuple[int, ...]) -> NDArray[np.bool_]:
        """Which genes (9, M) of the mutants are drawn anew."""
        if not self._by_individual:
            return self._random.random(shape) < self._mutation
        chosen = self._random.random(shape[1]) < self._mutation
        gene = self._random.integers(shape[0], size=shape[1])
        return (np.arange(shape[0])[:, None] == gene) & chosen

    def _select(self, fitness: Array, count: int) -> NDArray[np.intp]:
        """Stochastic universal selection: one throw, evenly spaced pointers on the wheel, then shuffled into pairs."""
        pointers = (self._random.random() + np.arange(count)) / count
        chosen = np.searchsorted(np.cumsum(fitness) / np.sum(fitness), pointers)
        return self._random.permutation(np.minimum(chosen, len(fitness) - 1))
