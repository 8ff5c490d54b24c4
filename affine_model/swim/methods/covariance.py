"""CMA-ES (package cmaes; Hansen 2016), several runs side by side so that a batch of the kernel is full.

A run without progress starts again elsewhere, because the objective has several maxima (one for each shape of the
wave). The last digits come from the local climbs (polish).
"""

from __future__ import annotations

import numpy as np
from cmaes import CMA

from affine_model.curvature import Array
from tentacle.gait import GAIT_PARAMETERS

_GOES_AROUND = 3  # the phases are the last three coordinates: no bound, they are taken modulo 1
_PATIENCE = 20  # generations over which the best must rise ...
_RISE = 1e-3  # ... by this share


class CovarianceEvolution:
    """`runs` independent CMA-ES of `population` points each; one that has converged starts anew elsewhere."""

    def __init__(self, seed: int, population: int = 16, runs: int = 3, sigma: float = 0.25) -> None:
        self._random = np.random.default_rng(seed)
        self._population, self._sigma = population, sigma
        self._runs = [self._fresh() for _ in range(runs)]
        self._bests: list[list[float]] = [[] for _ in range(runs)]

    def _fresh(self) -> CMA:
        bounds = np.tile([0.0, 1.0], (GAIT_PARAMETERS, 1))
        bounds[-_GOES_AROUND:] = [-1e3, 1e3]
        return CMA(
            mean=self._random.uniform(0.1, 0.9, GAIT_PARAMETERS),
            sigma=self._sigma,
            bounds=bounds,
            population_size=self._population,
            seed=int(self._random.integers(2**31)),
        )

    def ask(self) -> Array:
        """The points (9, B) of all runs."""
        return np.array([run.ask() for run in self._runs for _ in range(self._population)]).T

    def tell(self, unit: Array, scores: Array) -> None:
        """Hand every run its own points; cmaes minimises."""
        for number, run in enumerate(self._runs):
            own = range(number * self._population, (number + 1) * self._population)
            run.tell([(unit[:, index], -float(scores[index])) for index in own])
            bests = self._bests[number]
            bests.append(float(max(np.max(scores[own]), bests[-1] if bests else -np.inf)))
            still = len(bests) > _PATIENCE and bests[-1] - bests[-_PATIENCE - 1] <= _RISE * abs(bests[-1])
            if still or run.should_stop():
                self._runs[number], self._bests[number] = self._fresh(), []
