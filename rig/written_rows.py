"""The rows that a run's file was given so far: how many each entity has, and the checksums that are not yet written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from numpy.typing import NDArray

from tentacle.io.checksums import Sum, columns_digest


class WrittenRows:
    """Counts rows and sums them up, block by block. ends: rows of each entity so far."""

    def __init__(self) -> None:
        self.ends: dict[str, int] = {}
        self._sums: list[Sum] = []
        self._block = 0

    def count(self, entity: str, rows: int) -> int:
        """Counts more rows of an entity; how many there were before."""
        before = self.ends.get(entity, 0)
        self.ends[entity] = before + rows
        return before

    def sum(self, entity: str, columns: Mapping[str, NDArray[Any] | Sequence[str]]) -> int:
        """Counts the next rows of an entity, (N,) of each column, and keeps their checksum; the first's number."""
        count = len(next(iter(columns.values())))
        first = self.count(entity, count)
        self._sums.append(Sum(entity, first, count, columns_digest(columns)))
        return first

    def take(self) -> tuple[list[Sum], int]:
        """The checksums since the last call, and the number of their block; none begin no block."""
        sums, block = self._sums, self._block
        self._sums = []
        self._block += bool(sums)
        return sums, block
