"""Fits that run at the same time: the kernel and the filter let other threads run while they compute."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

import numpy as np

T = TypeVar("T")


def side_by_side(tasks: Iterable[Callable[[], T]]) -> list[T]:
    """The results, in the order of the tasks, of those whose runs did not leave all bounds."""
    workers = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 2
    with ThreadPoolExecutor(workers) as pool:
        results: list[T | None] = list(pool.map(lambda task: _done(task), tasks))
    return [result for result in results if result is not None]


def _done(task: Callable[[], T]) -> T | None:
    """The task's result; None where its runs left all bounds, so that no likelihood is known of it."""
    try:
        return task()
    except np.linalg.LinAlgError:
        return None
