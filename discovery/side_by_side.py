"""Tasks that run at the same time, on every core this process may use.

A third of a fit is Python, which one process runs one thread at a time. So on Linux the tasks run in forked processes,
which begin with all that the tasks need. Elsewhere they run in threads. So they do where another thread of Python is
alive, because a forked process would wait for ever for a lock that this thread held. Where a GPU simulates, the tasks
run one after another: a forked process cannot use CUDA, and threads would wait for the one device.
"""

from __future__ import annotations

import ctypes
import gc
import multiprocessing
import os
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any, TypeVar

import numpy as np

from affine_model.cores import usable_cores, use_one_core
from affine_model.effects import catalogue
from discovery.shared_pickle import reachable, received, sent
from inference.experiment import Experiment

T = TypeVar("T")
_PARENT_DEATH = 1  # PR_SET_PDEATHSIG of Linux
_work: tuple[list[Callable[[], Any]], dict[int, Any]] = [], {}  # what a forked process finds


def side_by_side(tasks: Iterable[Callable[[], T]]) -> list[T]:
    """The results, in the order of the tasks, of those whose runs did not leave all bounds."""
    waiting = list(tasks)
    workers = min(usable_cores(), len(waiting))
    if workers < 2 or _on_device(waiting):
        results = [_done(task) for task in waiting]
    elif _may_fork():
        results = _forked(waiting, workers)
    else:
        with ThreadPoolExecutor(workers) as pool:
            results = list(pool.map(lambda task: _done(task), waiting))
    return [result for result in results if result is not None]


def _on_device(tasks: list[Callable[[], T]]) -> bool:
    """Whether the tasks have an experiment that a CUDA device simulates."""
    return any(isinstance(one, Experiment) and one.device is not None for one in reachable(tasks).values())


def _may_fork() -> bool:
    """Whether no lock that a task needs can be held: a progress bar's thread, alone, holds none of these."""
    others = [one for one in threading.enumerate() if one is not threading.current_thread()]
    drawing = all(type(one).__module__.startswith("rich.") for one in others)
    return sys.platform == "linux" and drawing and not multiprocessing.current_process().daemon


def _done(task: Callable[[], T]) -> T | None:
    """The task's result; None where its runs left all bounds, so that no likelihood is known of it."""
    try:
        return task()
    except np.linalg.LinAlgError:
        return None


def _forked(tasks: list[Callable[[], T]], workers: int) -> list[T | None]:
    """The results of the tasks in forked processes; in this one if the system ends one of them (no memory)."""
    global _work
    shared, before = reachable([*tasks, *catalogue().values()]), set(multiprocessing.active_children())
    _work = tasks, shared
    try:
        with (
            warnings.catch_warnings(),
            ProcessPoolExecutor(workers, multiprocessing.get_context("fork"), _begin, (os.getpid(),)) as pool,
        ):
            # Python warns of all threads, those of numerical libraries too: these wait between calls.
            warnings.filterwarnings("ignore", message=".*fork.*", category=DeprecationWarning)
            try:
                return [received(text, shared) for text in pool.map(_result, range(len(tasks)))]
            except BaseException:
                for child in set(multiprocessing.active_children()) - before:
                    child.kill()
                raise
    except BrokenProcessPool:
        return [_done(task) for task in tasks]
    finally:
        _work = [], {}


def _begin(parent: int) -> None:
    """A forked process: it computes on one core, leaves interrupts to its parent, and ends with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    ctypes.CDLL(None).prctl(_PARENT_DEATH, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)
    gc.freeze()  # what the parent made is the parent's to end: a stream of Rerun would wait for its threads
    sys.stderr = os.fdopen(os.dup(2), "w")  # a thread of the parent may have held the lock of the old one
    use_one_core()


def _result(place: int) -> bytes:
    tasks, shared = _work
    return sent(_done(tasks[place]), shared)
