"""A signal ends a command even where Python cannot raise the interrupt: within a __del__, or a callback from C."""

from __future__ import annotations

import ctypes
import os
import signal
import time
from collections.abc import Callable

import pytest

from tentacle.cli._endings import told
from tentacle.cli._stop_signals import signals_as_interrupts

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


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


@pytest.mark.parametrize("lost", [within_c, within_removal, then_broken])
@pytest.mark.parametrize("number", SIGNALS, ids=lambda number: number.name)
def test_a_lost_interrupt_still_ends_the_command(
    number: int, lost: Callable[[int], None], capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tentacle.cli._endings._close_output", lambda: None)  # the test's own goes on
    before = [signal.getsignal(one) for one in SIGNALS]
    with signals_as_interrupts() as asked, told(asked) as outcome:
        lost(number)
    assert outcome.code == 128 + number
    assert capfd.readouterr().err == "tentacle: stopped\n"
    assert [signal.getsignal(one) for one in SIGNALS] == before
