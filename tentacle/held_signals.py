"""Signals that end a program wait while it starts a process.

A started Python reads from its parent what it is to do. If a signal's handler raises in the parent before that is
written, the child ends with a traceback of its own. And Ctrl-C reaches every process of a terminal: a child that is
still starting would end with a traceback too.

A mask alone does not hold a signal back from the parent. The kernel gives it to any thread that does not mask it, and
Python then runs the handler in the main thread.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

HELD = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGALRM")  # those that the system has; the last raises again


@contextmanager
def signals_held() -> Iterator[None]:
    """Inside, no handler of these signals runs; it does at the end. A process that is started inside has Ctrl-C masked,
    and so has what it starts, unless it changes that.
    """
    waiting: list[int] = []
    numbers = [getattr(signal, name) for name in HELD if hasattr(signal, name)]
    mine = threading.current_thread() is threading.main_thread()  # no other thread may set a handler, and none runs one
    before = {number: signal.getsignal(number) for number in numbers if mine and callable(signal.getsignal(number))}
    for number in before:
        signal.signal(number, lambda number, _frame: waiting.append(number))
    masks = hasattr(signal, "pthread_sigmask")  # Windows has none; there a child's traceback on Ctrl-C harms nothing
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT}) if masks else None
    try:
        yield
    finally:
        if mask is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        for number, handler in before.items():
            signal.signal(number, handler)
        for number in waiting:
            handler = before[number]
            assert callable(handler)
            handler(number, None)
