"""A signal that comes while a process is started waits until it is started."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tentacle.held_signals import signals_held

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows sends no signals")
ASKS = """\
import os, signal, sys, threading, time
from multiprocessing import util
from pathlib import Path
from tentacle.runner import Runner

def none(task):
    return {}

if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job ignores it
    threading.Thread(target=threading.Event().wait, daemon=True).start()  # it masks nothing: the kernel asks it
    start = util.spawnv_passfds

    def stopped_as_it_starts(*words):
        child = start(*words)
        if "spawn_main" in str(words):  # a worker, and not what keeps the books of semaphores
            os.killpg(0, signal.SIGINT)  # as a terminal does
            time.sleep(0.1)
        return child

    util.spawnv_passfds = stopped_as_it_starts
    Runner(Path(sys.argv[1]), workers=1, quiet=True).run(none, [{}])
"""


@pytest.fixture
def beside() -> Iterator[None]:
    """A thread that masks nothing, so that the kernel can give it any signal of this process."""
    done = threading.Event()
    other = threading.Thread(target=done.wait)
    other.start()
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job ignores it
    yield
    signal.signal(signal.SIGINT, before)
    done.set()
    other.join()


@pytest.mark.usefixtures("beside")
def test_ctrl_c_waits_for_the_end_of_the_block() -> None:
    ended = False
    try:
        with signals_held():
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(0.1)
            ended = True
    except KeyboardInterrupt:
        assert ended
    else:
        pytest.fail("the signal was lost")


@pytest.mark.usefixtures("beside")
def test_every_handler_is_as_before_and_gets_its_signal() -> None:
    got: list[int] = []

    def keep(number: int, _frame: object) -> None:
        got.append(number)

    before = signal.signal(signal.SIGTERM, keep)
    try:
        with signals_held():
            os.kill(os.getpid(), signal.SIGTERM)
            time.sleep(0.1)
            assert got == []
        assert got == [signal.SIGTERM]
        assert signal.getsignal(signal.SIGTERM) is keep
        assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())
    finally:
        signal.signal(signal.SIGTERM, before)


def test_a_thread_that_is_not_the_first_may_start_a_process_too() -> None:
    ended: list[bool] = []

    def start() -> None:
        with signals_held():
            ended.append(True)

    other = threading.Thread(target=start)
    other.start()
    other.join()
    assert ended == [True]


def test_a_worker_that_is_stopped_as_it_starts_says_nothing(tmp_path: Path) -> None:
    (tmp_path / "asks.py").write_text(ASKS)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run(
        [sys.executable, str(tmp_path / "asks.py"), str(tmp_path / "results")],
        env=environment, capture_output=True, text=True, timeout=60, start_new_session=True, check=False,
    )  # fmt: skip
    assert done.returncode in (-signal.SIGINT, 130)
    assert "EOFError" not in done.stderr
    assert done.stderr.count("Traceback") == 1  # the asking program's own: it has no command line around it
    assert "KeyboardInterrupt" in done.stderr.splitlines()[-1]
