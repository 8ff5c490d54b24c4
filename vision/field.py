"""A grey that changes smoothly over the picture: bilinear between the nodes of a grid, fitted to greys at places."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from scipy.linalg import solveh_banded

from tentacle.compiled import njit
from tentacle.signals import Array

NODES, FINEST = 40, 6.0  # along the picture's longer side; px between two of a small picture
SMOOTH = (25.0, 1e5, 1.6e6)  # prior information on the second differences, in pixels: for uneven and for even light
EMPTY = 1e-6  # prior information on each node, so that nodes without data stay finite
TOLD = ("normal", "right", "count", "power")


@dataclass(frozen=True)
class Field:
    """Nodes (columns x rows, a column's nodes in a row) cell [px] apart, the first at (0, 0).

    smooth: its smoothness, one of SMOOTH. grey (N,): the field at the last solution. count (N,): number of pixels at
    each node. normal (rows + 2, N), right (N,), power: the least squares' normal equations, the matrix by its lower
    diagonals, and the greys' sum of squares.
    """

    cell: float
    columns: int
    rows: int
    smooth: float
    grey: Array
    count: Array
    normal: Array
    right: Array
    power: float

    @staticmethod
    def over(size: tuple[int, int]) -> Field:
        """A field without data, over pictures of a size (width, height) [px]."""
        cell = max(max(size) / (NODES - 1.0), FINEST)
        columns, rows = (max(int(np.ceil(side / cell)) + 1, 3) for side in size)
        nothing = np.zeros(columns * rows)
        normal = np.zeros((rows + 2, len(nothing)))
        return Field(cell, columns, rows, SMOOTH[0], nothing, nothing, normal, nothing, 0.0)

    def fading(self, share: float) -> Field:
        """The field with its data weighted by a share (forgetting)."""
        told = {name: share * getattr(self, name) for name in TOLD}
        return replace(self, **told)

    def adding(self, place: Array, grey: Array, pixels: Array) -> Field:
        """The field with further data: greys (P,) at places (P, 2) [px], each the mean of a number of pixels (P,); not
        yet solved.
        """
        normal, right, count = self.normal.copy(), self.right.copy(), self.count.copy()
        _add(self._grid, (np.ascontiguousarray(place), grey, pixels), (normal, right, count))
        return replace(self, normal=normal, right=right, count=count, power=self.power + float(pixels @ grey**2))

    def joined(self, other: Field) -> Field:
        """The field with the data of both; not yet solved."""
        told = {name: getattr(self, name) + getattr(other, name) for name in TOLD}
        return replace(self, **told)

    def settled(self) -> Field:
        """The field with the greys that fit the data best."""
        matrix = self.smooth * _second_differences(self.columns, self.rows)
        matrix[0] += EMPTY
        matrix[: len(self.normal)] += self.normal
        return replace(self, grey=np.asarray(solveh_banded(matrix, self.right, lower=True, check_finite=False)))

    def chosen(self, noise: float) -> Field:
        """The field with the smoothness of the best Akaike criterion, solved. noise: of a pixel [grey]."""
        ways = [replace(self, smooth=smooth).settled() for smooth in SMOOTH]
        return min(ways, key=lambda way: way.misfit() / noise**2 + 2.0 * way.freedom())

    def misfit(self) -> float:
        """The sum of squares that is left, each pixel counted."""
        grey = self.grey
        fitted = self.normal[0] @ grey**2
        for step in range(1, len(self.normal)):
            fitted += 2.0 * self.normal[step, :-step] @ (grey[:-step] * grey[step:])
        return float(self.power - 2.0 * self.right @ grey + fitted)

    def freedom(self) -> float:
        """Effective number of parameters: about the trace of its influence matrix, for evenly spread data."""
        told = self.count > 0.0
        if not told.any():
            return 0.0
        stiff = [(2.0 - 2.0 * np.cos(np.pi * np.arange(n) / n)) ** 2 for n in (self.columns, self.rows)]
        held = self.smooth * (stiff[0][:, None] + stiff[1][None, :]) / float(self.count[told].mean())
        return float(told.mean() * np.sum(1.0 / (1.0 + held)))

    def at(self, place: Array) -> Array:
        """Greys (P,) at places (P, 2) [px]; beyond the picture, those of the last cell's plane."""
        return _values(*self._grid, self.grey, np.ascontiguousarray(place))

    def told(self, place: Array) -> Array:
        """Number of pixels (P,) at the nodes around places (P, 2) [px]."""
        return _values(*self._grid, self.count, np.ascontiguousarray(place))

    @property
    def _grid(self) -> tuple[float, int, int]:
        return self.cell, self.columns, self.rows


@cache
def _second_differences(columns: int, rows: int) -> Array:
    """Lower diagonals (2 rows + 1, N) of the matrix that gives the second differences' sum of squares."""
    index = np.arange(columns * rows).reshape(columns, rows)
    band = np.zeros((2 * rows + 1, columns * rows))
    for lines, step in ((index, rows), (index.T, 1)):
        first, middle, last = (line.ravel() for line in (lines[:-2], lines[1:-1], lines[2:]))
        band[0, first] += 1.0
        band[0, middle] += 4.0
        band[0, last] += 1.0
        band[step, first] -= 2.0
        band[step, middle] -= 2.0
        band[2 * step, first] += 1.0
    return band


@njit(cache=True, inline="always")
def _hats(u: float, v: float, cell: float, columns: int, rows: int) -> tuple[int, float, float]:
    """The node before a place, and the place's shares of a cell beyond it."""
    column = min(max(int(u / cell), 0), columns - 2)
    row = min(max(int(v / cell), 0), rows - 2)
    return column * rows + row, u / cell - column, v / cell - row


@njit(cache=True, nogil=True)
def _values(cell: float, columns: int, rows: int, field: Array, place: Array) -> Array:
    values = np.empty(len(place))
    for k in range(len(place)):
        node, a, b = _hats(place[k, 0], place[k, 1], cell, columns, rows)
        before = (1.0 - b) * field[node] + b * field[node + 1]
        values[k] = (1.0 - a) * before + a * ((1.0 - b) * field[node + rows] + b * field[node + rows + 1])
    return values


@njit(cache=True, nogil=True)
def _add(grid: tuple[float, int, int], told: tuple[Array, Array, Array], sums: tuple[Array, Array, Array]) -> None:
    """Add pixels (place, grey, number of them) to the sums (normal, right, count) of a field's nodes."""
    cell, columns, rows = grid
    place, grey, pixels = told
    normal, right, count = sums
    for k in range(len(place)):
        node, a, b = _hats(place[k, 0], place[k, 1], cell, columns, rows)
        nodes = (node, node + 1, node + rows, node + rows + 1)
        share = ((1.0 - a) * (1.0 - b), (1.0 - a) * b, a * (1.0 - b), a * b)
        for i in range(4):
            leaned = pixels[k] * share[i]
            right[nodes[i]] += leaned * grey[k]
            count[nodes[i]] += leaned
            for j in range(i + 1):
                normal[nodes[i] - nodes[j], nodes[j]] += leaned * share[j]
