"""One suspicion about a recording, as tentacle.slips finds it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Slip:
    """One suspicion: the file and field that it concerns, what is seen with its numbers, and the remedy."""

    file: str
    field: str
    seen: str
    remedy: str
    certain: bool

    def line(self) -> str:
        """As it is printed."""
        return f"{self.file}: {self.field}: {self.seen}; {self.remedy}"
