"""Unknown constants of a recording, marginalised out of rows that are whitened for everything else.

    w = X c + noise,  c ~ N(0, 1):    cov(w) = 1 + X X',    (1 + X X')^-1/2 = 1 - X A X'

X (N, S): what a unit of each constant does to the rows. With X'X = V diag(l) V' and r = sqrt(1 + l),
A = V diag(1 / (r (1 + r))) V'.
A filter that held them in its state would carry as many states that never move through every cell.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from affine_model.curvature import Array


@dataclass(frozen=True)
class UnknownConstants:
    """columns (N, S): X, each constant in units of its prior; weight (S, S): A; log_determinant: half that of
    1 + X X' [nats].
    """

    columns: Array
    weight: Array
    log_determinant: float

    @staticmethod
    def of(columns: Array) -> UnknownConstants:
        """The constants that do this (N, S) to the rows."""
        values, vectors = np.linalg.eigh(columns.T @ columns)
        values = np.maximum(values, 0.0)
        root = np.sqrt(1.0 + values)
        weight = (vectors / (root * (1.0 + root))) @ vectors.T
        return UnknownConstants(columns, weight, 0.5 * float(np.log1p(values).sum()))

    def freed(self, rows: Array) -> Array:
        """Rows (N, B) of unit variance once more."""
        return np.asarray(rows - self.columns @ (self.weight @ (self.columns.T @ rows)))
