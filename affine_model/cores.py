"""How many cores one computation may use, and how much time of them it took."""

from __future__ import annotations

import os

_only: int | None = None


def usable_cores() -> int:
    """The cores that this process may use, or fewer where it was told so."""
    if _only is not None:
        return _only
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def use_one_core() -> None:
    """From now on this process computes on one core: others like it run beside it."""
    global _only
    _only = 1


def processor_seconds() -> float:
    """Processor time [s] of this process and of its children that have ended."""
    return sum(os.times()[:4])
