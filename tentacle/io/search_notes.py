"""Notes of a running search, from which an interrupted search continues."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from tentacle.io.written_file import write_text
from tentacle.signals import Array


class Noted(Protocol):
    """A generation of a search: its number from 0, and its scores (B,)."""

    @property
    def number(self) -> int:
        """From 0."""
        ...

    @property
    def scores(self) -> Array:
        """(B,)."""
        ...


class SearchNotes:
    """The scores of a running search, one JSON line a generation."""

    def __init__(self, path: Path, inputs: dict[str, Any]) -> None:
        """`inputs` name the search; notes of another search are put aside by overwriting."""
        self._path = path
        self.key = hashlib.sha256(json.dumps(inputs, sort_keys=True).encode()).hexdigest()

    def scores(self) -> Iterator[Array]:
        """The generations noted so far; the file is cut after its last complete line, and started again for another
        search.
        """
        self._path.parent.mkdir(parents=True, exist_ok=True)
        text = self._path.read_text(encoding="utf-8") if self._path.exists() else ""
        lines = text[: text.rfind("\n") + 1].splitlines()
        if not lines or lines[0] != json.dumps({"search": self.key}):
            lines = [json.dumps({"search": self.key})]
        write_text(self._path, "\n".join(lines) + "\n")
        self._noted = len(lines[1:])
        return iter([np.array(json.loads(line)) for line in lines[1:]])

    def note(self, generation: Noted) -> None:
        """Add a generation, unless it was read from these notes."""
        if generation.number >= self._noted:
            with self._path.open("a", encoding="utf-8") as file:
                file.write(json.dumps(generation.scores.tolist()) + "\n")
