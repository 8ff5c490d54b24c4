"""A command in a shell that limits memory (ulimit -v, -d): what native code then does becomes one line.

Rerun, Arrow and glibc end the process where they cannot get memory, and nothing within that process can prevent it.
OpenBLAS is worse: it asks again for ever, when it is loaded (seen with 1.1 GB of address space) and when it is first
used (1.8 GB). Therefore a limit below LEAST is refused. Above it, OpenBLAS is used at once, so that it has its buffers
before the work begins, and the command runs in a child, whose end this process reports. Without a limit nothing of
this happens.

mimalloc, in Rerun and in Arrow, reserves a gigabyte each time it is loaded. Under a limit it is told to reserve less.
LEAST: the largest address space that a verb then used on small recordings was 2.4 GB on two cores (optimise); a core
more takes .1 to .4 GB, for its threads. Of data (ulimit -d) .6 GB were enough.
"""

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress

from tentacle.errors import InputError

LEAST = {"RLIMIT_AS": (2.0e9, 0.25e9, "ulimit -v"), "RLIMIT_DATA": (0.8e9, 0.1e9, "ulimit -d")}  # bytes, a core more
LEAST_FILES = 64  # open at once; the verbs had up to 22
OWN_ENDS = (0, 1, 2, 3, 70)  # exit codes of ours; beside them those of signals that ask for an end
ENDS_ASKED = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT")
REFUSED = 2  # exit code
RESERVED = {"MIMALLOC_ARENA_RESERVE": "65536", "ARROW_DEFAULT_MEMORY_POOL": "system"}  # KiB; glibc's malloc
WHAT_WE_SAY = (b"tentacle: ", b"0.", b"1.")  # beginnings of our own lines: a message, the share done
DIES_WITH_PARENT = 1  # PR_SET_PDEATHSIG of Linux


def memory_is_limited() -> bool:
    """Whether this process may use only so much memory."""
    if sys.platform == "win32":
        return False
    import resource

    limits = (resource.getrlimit(kind)[0] for kind in (resource.RLIMIT_AS, resource.RLIMIT_DATA))
    return any(limit != resource.RLIM_INFINITY for limit in limits)


def require_memory() -> None:
    """InputError where a limit is below what the libraries take when they are loaded. Of open files, too: Rerun ends
    the process where it cannot open one.
    """
    if sys.platform == "win32":
        return
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft != resource.RLIM_INFINITY and soft < LEAST_FILES:
        allowed = LEAST_FILES if hard == resource.RLIM_INFINITY else min(hard, LEAST_FILES)
        resource.setrlimit(resource.RLIMIT_NOFILE, (allowed, hard))
        if allowed < LEAST_FILES:
            problem = f"the shell allows {allowed} open files (ulimit -n)"
            raise InputError(problem, expected=f"{LEAST_FILES} or more")
    cores = os.cpu_count() or 1
    for kind, (base, a_core, words) in LEAST.items():
        allowed, least = resource.getrlimit(getattr(resource, kind))[0], base + a_core * cores
        if allowed != resource.RLIM_INFINITY and allowed < least:
            problem = f"the shell allows {allowed / 1e6:.0f} MB of memory ({words})"
            raise InputError(problem, expected=f"{least / 1e6:.0f} MB or more, or no limit")
    if memory_is_limited():
        _use_blas()


def _use_blas() -> None:
    """NumPy's OpenBLAS and SciPy's each take 32 MB at their first use and keep it."""
    import numpy as np
    import scipy.linalg

    np.linalg.solve(np.eye(2), np.ones(2))
    scipy.linalg.solve(np.eye(2), np.ones(2))


def watched_child() -> int | None:
    """None in the child, which is to run the command; in this process the exit code, after the child has ended."""
    for name, value in RESERVED.items():
        os.environ.setdefault(name, value)
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
    asked = [128 + getattr(signal, name) for name in ENDS_ASKED]
    crashed = status not in (*OWN_ENDS, *asked, *(128 - code for code in asked))
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

    for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
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
