"""SIGINT, SIGTERM and SIGHUP (a closed terminal) end a command as Ctrl-C does, even where the interrupt is lost.

A signal's handler raises Ended wherever the program is. Within a callback from C code, or while an object is being
removed, Python can raise nothing: it reports the exception (sys.unraisablehook) and goes on. numba's compiler is such
a place. There, the exception is raised again a moment later.
"""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType
from typing import Any

AGAIN_AFTER = 0.1  # s


class Ended(KeyboardInterrupt):
    """A signal asked the program to end: it does so as after Ctrl-C, which every verb knows to leave nothing behind."""

    def __init__(self, number: int) -> None:
        self.number = number
        super().__init__()


@dataclass
class StopAsked:
    """number: of the signal that asked the command to end, 0 where none did."""

    number: int = 0

    def handle(self, number: int, _frame: FrameType | None) -> None:
        """The signals' handler."""
        if number != signal.SIGINT:
            signal.signal(number, signal.SIG_IGN)  # once is enough: what cleans up is not to be interrupted
        self.number = number
        raise Ended(number)

    def again(self, _number: int, _frame: FrameType | None) -> None:
        """The timer's handler: what was lost is raised once more."""
        raise Ended(self.number)


@contextmanager
def signals_as_interrupts() -> Iterator[StopAsked]:
    """Inside, the signals raise Ended, unless whoever started us ignores them."""
    asked = StopAsked()
    if sys.platform == "win32" or threading.current_thread() is not threading.main_thread():
        yield asked  # Windows has no alarm and no SIGHUP: there Ctrl-C is Python's own
        return
    usual = (signal.SIG_DFL, signal.default_int_handler)
    before = {
        number: signal.signal(number, asked.handle)
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
        if signal.getsignal(number) in usual
    }
    before[signal.SIGALRM] = signal.signal(signal.SIGALRM, asked.again)
    report, sys.unraisablehook = sys.unraisablehook, _raise_again
    try:
        yield asked
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        sys.unraisablehook = report
        for number, handler in before.items():
            signal.signal(number, handler)


def _raise_again(unraisable: Any) -> None:
    """An interrupt that could not be raised is raised a moment later; what else could not be is reported as usual."""
    if not isinstance(unraisable.exc_value, KeyboardInterrupt):
        sys.__unraisablehook__(unraisable)
    elif isinstance(unraisable.exc_value, Ended):
        signal.setitimer(signal.ITIMER_REAL, AGAIN_AFTER)
