"""A signal ends a command even where Python cannot raise the interrupt: within a __del__, or a callback from C."""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import time
from collections.abc import Callable
from typing import ClassVar

import pytest

from tentacle.cli._endings import told
from tentacle.cli._stop_signals import signals_as_interrupts

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)


def ask(number: int) -> None:
    os.kill(os.getpid(), number)
    time.sleep(0.01)  # the handler runs here


def within_c(number: int) -> None:
    ctypes.CFUNCTYPE(None)(lambda: ask(number))()
    time.sleep(5.0)


def within_removal(number: int) -> None:
    class Removed:
        def __del__(self) -> None:
            ask(number)

    Removed()
    time.sleep(5.0)


def then_broken(number: int) -> None:
    ctypes.CFUNCTYPE(None)(lambda: ask(number))()
    raise RuntimeError("no compiled object yet")


class HalfMade:
    """As llvmlite's: what its maker did not reach is missing when it is removed."""

    kept: ClassVar[list[HalfMade]] = []

    def __init__(self, number: int) -> None:
        self.kept.append(self)
        ask(number)
        self.pointer = 1

    def __del__(self) -> None:
        del self.pointer


def within_numba(number: int) -> None:
    """It returns first: an exception out of numba's compiler crashes its dispatcher."""
    names = {"__name__": "numba.core.dispatcher", "ask": ask, "returned": []}
    exec("def compiled(number):\n    ask(number)\n    returned.append(True)", names)
    names["compiled"](number)
    assert names["returned"] == [True]
    time.sleep(5.0)


def swallowed(number: int) -> None:
    """As by glfw, when it looks for a module."""
    try:
        ask(number)
    except BaseException:
        time.sleep(0.2)  # within a clean-up nothing is raised again
    time.sleep(5.0)


@pytest.mark.parametrize("lost", [within_c, within_removal, then_broken, HalfMade, within_numba, swallowed])
@pytest.mark.parametrize("number", SIGNALS, ids=lambda number: number.name)
def test_a_lost_interrupt_still_ends_the_command(
    number: int, lost: Callable[[int], None], capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tentacle.cli._endings.close_output", lambda: None)  # the test's own goes on
    monkeypatch.setattr(sys, "unraisablehook", sys.unraisablehook)  # it is left silent after a signal
    before = [signal.getsignal(one) for one in SIGNALS]
    with signals_as_interrupts() as asked, told(asked) as outcome:
        lost(number)
    HalfMade.kept.clear()
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)
    assert outcome.code == 128 + number
    assert capfd.readouterr().err == "tentacle: stopped\n"
    assert [signal.getsignal(one) for one in SIGNALS] == before


def test_a_clean_up_is_not_interrupted(monkeypatch: pytest.MonkeyPatch) -> None:
    """It takes three times as long as a lost interrupt waits, with errors of its own that it handles."""
    monkeypatch.setattr("tentacle.cli._stop_signals.LOST_AFTER", 0.1)
    monkeypatch.setattr("tentacle.cli._endings.close_output", lambda: None)
    monkeypatch.setattr(sys, "unraisablehook", sys.unraisablehook)
    done: list[str] = []
    with signals_as_interrupts() as asked, told(asked) as outcome:
        try:
            ask(signal.SIGTERM)
        finally:
            try:
                raise OSError("cannot be removed")
            except OSError:
                time.sleep(0.3)
            done.append("cleaned")
    assert (done, outcome.code) == (["cleaned"], 143)


def test_a_second_ctrl_c_ends_a_clean_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """One that hangs, for instance."""
    monkeypatch.setattr("tentacle.cli._endings.close_output", lambda: None)
    monkeypatch.setattr(sys, "unraisablehook", sys.unraisablehook)
    done: list[str] = []
    with signals_as_interrupts() as asked, told(asked) as outcome:
        try:
            ask(signal.SIGINT)
        finally:
            ask(signal.SIGINT)
            done.append("cleaned")
    assert (done, outcome.code) == ([], 130)
