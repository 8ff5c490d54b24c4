"""Progress reports of long work to its caller."""

from __future__ import annotations

from typing import Protocol


class Stage(Protocol):
    """Called with the name of a stage, and with the share of it that is done."""

    def __call__(self, words: str, done: float = 0.0) -> None:
        """The words name a stage by their beginning; done is 0 to 1 within it."""


def silent(words: str, done: float = 0.0) -> None:
    """No report."""
