"""SIGINT, SIGTERM, SIGHUP (a closed terminal) and SIGQUIT end a command as Ctrl-C does, even where the interrupt is
lost.

A signal's handler raises Ended wherever the program is. Within a callback from C code, or while an object is being
removed, Python can raise nothing: it reports the exception (sys.unraisablehook) and goes on. And other people's code
may catch an interrupt and go on: glfw, which mujoco imports, does so. So Ended is raised again every LOST_AFTER, until
it reaches the end of the command. While an Ended is being handled (a clean-up), it waits.

numba's dispatcher, which is C code, crashes now and then if an exception comes out of the compiler that it called (4
of 120 interrupts of `track`). So Ended waits until numba has returned, but not longer than LONGEST_WAIT.

An object whose construction was interrupted may fail when it is removed; such errors are not reported.
"""

from __future__ import annotations

import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType
from typing import Any

AGAIN_AFTER = 0.1  # s
LOST_AFTER = 1.0  # s; a verb that catches the interrupt itself has ended by then
LONGEST_WAIT = 8.0  # s; a function of ours is loaded in less than .5 s and compiled in some seconds
COMPILERS = ("numba.", "llvmlite.")


class Ended(KeyboardInterrupt):
    """A signal asked the program to end. It ends as after Ctrl-C: every verb removes its unfinished files."""

    def __init__(self, number: int) -> None:
        self.number = number
        super().__init__()


@dataclass
class StopAsked:
    """number: of the signal that asked the command to end, 0 where none did; latest [s]: until when Ended may wait, by
    the monotonic clock.
    """

    number: int = 0
    latest: float = 0.0

    def handle(self, number: int, frame: FrameType | None) -> None:
        """The signals' handler."""
        if number != signal.SIGINT:
            signal.signal(number, signal.SIG_IGN)  # only once: the clean-up must not be interrupted
        self.latest = self.latest if self.number else time.monotonic() + LONGEST_WAIT
        self.number = number
        self.again(number, frame)

    def again(self, number: int, frame: FrameType | None) -> None:
        """The timer's handler: what was lost, or has waited, is raised. A second Ctrl-C ends a clean-up too."""
        if (number == signal.SIGALRM and _is_handled()) or (_compiles(frame) and time.monotonic() < self.latest):
            signal.setitimer(signal.ITIMER_REAL, AGAIN_AFTER)
            return
        signal.setitimer(signal.ITIMER_REAL, LOST_AFTER)
        raise Ended(self.number)

    def arrived(self) -> None:
        """The end of the command has caught what was raised: nothing is raised again."""
        if self.number:
            signal.setitimer(signal.ITIMER_REAL, 0.0)

    def unraisable(self, report: Any) -> None:
        """Python's hook for exceptions that cannot be raised: those of a program that ends are not reported."""
        if not self.number and not isinstance(report.exc_value, KeyboardInterrupt):
            sys.__unraisablehook__(report)


def _is_handled() -> bool:
    """Whether an `except`, a `finally` or an `__exit__` is at work on an Ended."""
    found = sys.exception()
    while found is not None and not isinstance(found, Ended):
        found = found.__context__
    return found is not None


def _compiles(frame: FrameType | None) -> bool:
    """Whether a compiler is at work in the frame, or in one that called it."""
    while frame is not None:
        if frame.f_globals.get("__name__", "").startswith(COMPILERS):
            return True
        frame = frame.f_back
    return False


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
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)
        if signal.getsignal(number) in usual
    }
    before[signal.SIGALRM] = signal.signal(signal.SIGALRM, asked.again)
    report, sys.unraisablehook = sys.unraisablehook, asked.unraisable
    try:
        yield asked
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        # After a signal the program ends, and what it leaves half made is removed only then.
        sys.unraisablehook = _say_nothing if asked.number else report
        for number, handler in before.items():
            signal.signal(number, handler)


def _say_nothing(_report: Any) -> None:
    """The hook of a program that was asked to end, once its command has ended."""
