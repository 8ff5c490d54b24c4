"""The priority of this process's threads, kept from a library that raises it."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

THREAD_FOLDER = Path("/proc/self/task")


@contextmanager
def kept_priority() -> Iterator[None]:
    """The block's threads keep, or get, the priority that this thread had before it.

    SVT-AV1, where it may (as root), makes its own threads and the one that starts it real-time ones of the highest
    priority. Threads and processes started later would inherit this priority, and would stop everything else on the
    machine while they compute. Other systems than Linux do not allow it, and nothing is done there.
    """
    if sys.platform != "linux":
        yield
        return
    policy, before = os.sched_getscheduler(0), os.sched_getparam(0)
    known = thread_policies()
    try:
        yield
    finally:
        for thread, now in thread_policies().items():
            if now != known.get(thread, policy):
                try:
                    os.sched_setscheduler(thread, policy, before)
                except ProcessLookupError:
                    continue  # it has ended meanwhile


def thread_policies() -> dict[int, int]:
    """The scheduling policy (SCHED_OTHER, SCHED_FIFO, ...) of each thread of this process, by its number."""
    policies = {}
    for folder in THREAD_FOLDER.iterdir():
        try:
            policies[int(folder.name)] = os.sched_getscheduler(int(folder.name))
        except ProcessLookupError:
            continue
    return policies
