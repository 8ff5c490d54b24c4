"""Ways to search the unit cube of gaits, one a file: each asks for a batch (9, B) and is told its scores (B,), higher
is better.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Protocol

from affine_model.curvature import Array
from affine_model.swim.methods.covariance import CovarianceEvolution
from affine_model.swim.methods.genetic import GeneticAlgorithm
from affine_model.swim.methods.random_search import RandomSearch


class Method(Protocol):
    """A search that goes by batches; the same seed and the same scores give the same batches."""

    def ask(self) -> Array:
        """The next points (9, B) of the unit cube; phases (the last three) may leave it, they go around."""
        ...

    def tell(self, unit: Array, scores: Array) -> None:
        """The scores (B,) of the points last asked for."""
        ...


METHODS: dict[str, Callable[[int], Method]] = {
    "cmaes": CovarianceEvolution,
    "ga": GeneticAlgorithm,
    "ga-individual": partial(GeneticAlgorithm, by_individual=True),
    "random": RandomSearch,
}

__all__ = ["METHODS", "CovarianceEvolution", "GeneticAlgorithm", "Method", "RandomSearch"]
