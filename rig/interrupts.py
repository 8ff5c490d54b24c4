"""Ctrl-C: once pauses at the next safe point, twice stops the motor now. The motor always ends at neutral."""

from __future__ import annotations

import signal
from collections.abc import Callable
from contextlib import suppress
from types import FrameType


class Interrupts:
    """Counts SIGINT while used as a context manager; `say` reports the effect of each.

    SIGTERM, SIGHUP of a terminal that was closed, and SIGQUIT count as two.
    """

    def __init__(self, say: Callable[[str], None]) -> None:
        self._say = say
        self._count = 0
        self._last = signal.SIGINT
        self._before: dict[int, object] = {}

    @property
    def pause(self) -> bool:
        """Whether to stop at the next safe point: between runs."""
        return self._count >= 1

    @property
    def stop_now(self) -> bool:
        """Whether the motor is to stop now."""
        return self._count >= 2

    @property
    def exit_code(self) -> int:
        """Of a command that the signals ended: 128 and the number of the last one."""
        return 128 + self._last

    def __enter__(self) -> Interrupts:
        names = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT")  # Windows has neither of the last two
        for number in (getattr(signal, name) for name in names if hasattr(signal, name)):
            self._before[number] = signal.signal(number, self._heard)
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)  # type: ignore[arg-type]

    def _heard(self, number: int, _frame: FrameType | None) -> None:
        self._last = signal.Signals(number)
        self._count += 1 if number == signal.SIGINT else 2
        with suppress(OSError, RuntimeError):  # the terminal itself may be closed
            if self._count == 1:
                self._say("pausing after this run; Ctrl-C again stops the motor now")
            else:
                self._say("stopping the motor")
