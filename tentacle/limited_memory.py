"""A command in a shell that limits memory (ulimit -v, -d): an abort of native code becomes one line.

Rerun, Arrow and BLAS end the process where they cannot get memory, and nothing within that process can prevent it.
Under such a limit the command therefore runs in a child, and this process reports the child's end. Without a limit no
child is started. Measured: `tentacle import` needs 1.1 to 1.6 GB of address space, more with more cores.
"""

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress

CRASHES = ("SIGABRT", "SIGSEGV", "SIGBUS", "SIGILL", "SIGTRAP", "SIGKILL")
REFUSED = 2  # exit code
WHAT_WE_SAY = (b"tentacle: ", b"0.", b"1.")  # beginnings of our own lines: a message, the share done
DIES_WITH_PARENT = 1  # PR_SET_PDEATHSIG of Linux


def memory_is_limited() -> bool:
    """Whether this process may use only so much memory."""
    if sys.platform == "win32":
        return False
    import resource

    limits = (resource.getrlimit(kind)[0] for kind in (resource.RLIMIT_AS, resource.RLIMIT_DATA))
    return any(limit != resource.RLIM_INFINITY for limit in limits)


def watched_child() -> int | None:
    """None in the child, which is to run the command; in this process the exit code, after the child has ended."""
    sys.stdout.flush()
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        _die_with_parent()
        os.dup2(writing, 2)
        os.close(reading)
        os.close(writing)
        return None
    os.close(writing)
    _pass_signals_to(child)
    held = _pass_lines(reading)
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    crashed = status < 0 and signal.Signals(-status).name in CRASHES
    line = "tentacle: not enough memory for this command under the shell's limit; expected more (ulimit -v)\n"
    with suppress(OSError):
        os.write(2, line.encode() if crashed else held)
    return REFUSED if crashed else status if status >= 0 else 128 - status


def _die_with_parent() -> None:
    """Where the system can: the child gets SIGTERM if this process is killed."""
    if sys.platform == "linux":
        import ctypes

        with suppress(OSError, AttributeError):
            ctypes.CDLL(None).prctl(DIES_WITH_PARENT, signal.SIGTERM, 0, 0, 0)


def _pass_signals_to(child: int) -> None:
    """Pass signals on. A terminal sends its Ctrl-C to the child itself."""

    def pass_on(number: int, _frame: object) -> None:
        with suppress(ProcessLookupError):
            os.kill(child, number)

    for number in (signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, pass_on)
    signal.signal(signal.SIGINT, signal.SIG_IGN if os.isatty(0) else pass_on)


def _pass_lines(reading: int) -> bytes:
    """Copy our own lines to standard error as they come; the others, for a child that does not crash."""
    held = b""
    with open(reading, "rb") as lines:
        for line in lines:
            if line.startswith(WHAT_WE_SAY):
                with suppress(OSError):
                    os.write(2, line)
            else:
                held += line
    return held
