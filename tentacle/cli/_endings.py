"""The end of a command: done, an error in one line, or stopped by a signal. No unfinished file is left.

| exit code | |
|---|---|
| 0 | done |
| 2 | bad input, a full disk, a missing package: one line says what |
| 70 | a defect of this program: one line says where its trace lies |
| 128 + number | a signal: 130 Ctrl-C, 143 SIGTERM, 129 SIGHUP, 131 SIGQUIT |
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from tentacle.cli._error_words import first_line, os_words, trace_of
from tentacle.cli._output import close_output, remark
from tentacle.cli._stop_signals import Ended, StopAsked
from tentacle.compiled_modules import remove_torn_modules, torn_module
from tentacle.errors import InputError, printable

# Optional modules: module -> the extra that installs it.
EXTRAS = {
    "serial": "rig", "optuna": "rig", "distributed": "cluster", "torch": "gpu", "warp": "gpu", "nicegui": "app",
    "h5py": "hdf5",
}  # fmt: skip
NO_MEMORY = ("failed to map segment", "cannot allocate memory")  # glibc's words where a library does not fit
NO_THREAD = "can't start new thread"  # Python's words, of all that a thread can lack
BAD_INPUT, DEFECT = 2, 70


@dataclass
class CommandEnd:
    """The exit code of a command."""

    code: int = 0


@contextmanager
def told(asked: StopAsked) -> Iterator[CommandEnd]:
    """Catch every error of the block, print it as one line, and give the exit code.

    asked: whether a signal asked the command to end. An error after the signal is its effect and no defect.
    """
    outcome = CommandEnd()
    try:
        yield outcome
    except SystemExit:
        raise
    except BaseException as error:
        asked.arrived()
        line, outcome.code = _told(error, asked)
        if line:
            remark(line)
        if outcome.code != BAD_INPUT or isinstance(error, OSError):
            close_output()


def _told(error: BaseException, asked: StopAsked) -> tuple[str, int]:
    """The line that describes an error ("" if nobody can read it) and the exit code."""
    match _root(error):
        case InputError() as bad:
            return bad.line(), BAD_INPUT
        case Ended() as ended:
            return "stopped", 128 + ended.number
        case KeyboardInterrupt():
            return "stopped", 130
        case ModuleNotFoundError() as missing if (missing.name or "").partition(".")[0] in EXTRAS:
            name = (missing.name or "").partition(".")[0]
            return f"{name} is not installed; expected pip install 'tentacle-twin[{EXTRAS[name]}]'", BAD_INPUT
        case BrokenPipeError():  # the reader of a pipe has gone: no message
            return "", 0
        case MemoryError():
            return "not enough memory for this; expected a smaller input", BAD_INPUT
        case ImportError() as failed if any(words in str(failed) for words in NO_MEMORY):
            return f"not enough memory to load what this needs: {printable(str(failed)[:200])}", BAD_INPUT
        case OSError() as failed:
            return os_words(failed), BAD_INPUT
        case UnicodeEncodeError() as failed:  # a file's name, found in a folder
            return f"{printable(str(failed.object)[:200])}: is no UTF-8; expected names in UTF-8", BAD_INPUT
        case RuntimeError() as failed if str(failed) == NO_THREAD:
            return "no thread can be started; expected more memory or processes (ulimit -v, -u)", BAD_INPUT
    if asked.number:
        return "stopped", 128 + asked.number
    torn = torn_module(error)
    if torn is not None:
        return printable(remove_torn_modules(torn)), BAD_INPUT
    return f"a defect of tentacle: {first_line(error)}; its trace is in {trace_of(error)}", DEFECT


def _root(error: BaseException) -> BaseException:
    """The first known error in a chain: numba and others wrap an interrupt in an error of their own."""
    found: BaseException | None = error
    while found is not None:
        if isinstance(found, InputError | KeyboardInterrupt | OSError | MemoryError | ImportError):
            return found
        found = found.__cause__ or found.__context__
    return error
