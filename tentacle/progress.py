"""How work that takes long says what it is at, to whoever asked for it."""

from __future__ import annotations

from typing import Protocol


class Stage(Protocol):
    """Told what begins, in words, and how much of that stage is done."""

    def __call__(self, words: str, done: float = 0.0) -> None:
        """The words name a stage by their beginning; done is 0 to 1 within it."""


def silent(words: str, done: float = 0.0) -> None:
    """Nobody asked."""
