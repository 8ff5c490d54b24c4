"""Errors and repetitions on the line between host and board."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class LineCounters:
    """Errors and repetitions so far; written into every recording."""

    commands: int = 0
    retries: int = 0
    host_bad_frames: int = 0
    board_bad_frames: int = 0
    samples_doubled: int = 0
    samples_asked_again: int = 0
    samples_lost: int = 0
    reconnects: int = 0
