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
        """The generations noted so far. The file is cut at its first unsound line; another search begins it again."""
        self._path.parent.mkdir(parents=True, exist_ok=True)
        lines = self._path.read_bytes().split(b"\n")[:-1] if self._path.exists() else []
        header = json.dumps({"search": self.key})
        noted = list[list[float]]()
        if lines and lines[0] == header.encode():
            for line in lines[1:]:
                scores = _sound_scores(line, len(noted))
                if scores is None:
                    break
                noted.append(scores)
        write_text(self._path, "\n".join([header, *map(_line, noted, range(len(noted)))]) + "\n")
        self._noted = len(noted)
        return iter([np.array(scores) for scores in noted])

    def note(self, generation: Noted) -> None:
        """Add a generation, unless it was read from these notes."""
        if generation.number >= self._noted:
            with self._path.open("a", encoding="utf-8") as file:
                file.write(_line(generation.scores.tolist(), generation.number) + "\n")


def _line(scores: list[float], number: int) -> str:
    text = json.dumps([number, scores])
    return json.dumps({"scores": scores, "sha256": hashlib.sha256(text.encode()).hexdigest()})


def _sound_scores(line: bytes, number: int) -> list[float] | None:
    """The scores of a line; None where it does not agree with its checksum."""
    try:
        scores = json.loads(line)["scores"]
        return scores if line.decode() == _line(scores, number) else None
    except (ValueError, KeyError, TypeError, RecursionError):
        return None
