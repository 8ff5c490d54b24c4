"""The ends of a log, of a servo or of a base that travels, that lie within the time for which the arm is seen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from tentacle.signals import Array

LEAST_MISSING = 0.1  # s of pictures beyond a log that are worth a word
LONGEST_REST = 0.1  # of the time for which the arm is seen: longer, what rests beyond its log is told


@dataclass(frozen=True)
class LogEnd:
    """verb: whether the log ends or begins at the time t [s]; missing [s] of pictures beyond it; start, stop [s]: of
    the pictures.
    """

    verb: Literal["ends", "begins"]
    t: float
    missing: float
    start: float
    stop: float

    def matters(self, moves: bool) -> bool:
        """Whether it is told. moves: whether what is logged moves there; it would go on beyond the log."""
        return self.missing >= (LEAST_MISSING if moves else LONGEST_REST * (self.stop - self.start))

    @property
    def words(self) -> str:
        """How much of the pictures the log has."""
        return f"{self.verb} at {self.t:.4g} s, and the arm is seen from {self.start:.4g} to {self.stop:.4g} s"


def log_ends(first: float, last: float, pictures: Array) -> list[LogEnd]:
    """The ends of a log from first to last [s] that lie far enough within these pictures' times (T,) to matter."""
    start, stop = float(pictures[0]), float(pictures[-1])
    ends = (
        LogEnd("ends", last, stop - last, start, stop),
        LogEnd("begins", first, first - start, start, stop),
    )
    return [end for end in ends if end.matters(moves=True) or end.matters(moves=False)]
