"""What a command prints. A name in it cannot command the terminal, and a lost output does not end the work.

Where the standard output takes nothing more (a full disk, a closed pipe), the command works on to its end and writes
its files. `require_taken` then reports a full disk. A reader that has gone (`| head`) is no error.
"""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from typing import TYPE_CHECKING

from tentacle.errors import printable

if TYPE_CHECKING:
    from pathlib import Path

    from rich.console import RenderableType
    from rich.text import Text

OUTPUT = "the standard output"
_lost: list[OSError] = []  # why the standard output takes nothing more


def begin_output() -> None:
    """At the start of a command: nothing is lost."""
    _lost.clear()


def say(*lines: str | Path) -> None:
    """Lines on the standard output; control characters are written out."""
    say_text("\n".join(printable(str(line)) for line in lines))


def say_text(text: str, end: str = "\n") -> None:
    """A text on the standard output as it is: JSON, a script or a question, without foreign control characters."""
    if _lost:
        return
    try:
        print(text, end=end, flush=True)
    except OSError as error:
        _lost.append(error)
        close_output()


def show(shown: RenderableType, width: int | None = None) -> None:
    """A rich table on the standard output. width: where the output is no terminal. Cells of foreign words: `cell`."""
    from rich.console import Console

    console = Console(width=None if Console().is_terminal else width, soft_wrap=width is None)
    with console.capture() as captured:
        console.print(shown)
    say_text(captured.get().removesuffix("\n"))


def cell(words: str) -> Text:
    """A table's cell or title of foreign words: without markup and control characters."""
    from rich.text import Text

    return Text(printable(words))


def remark(words: str, before: str = "tentacle: ") -> None:
    """A line on standard error, where it can be written; control characters are written out."""
    with suppress(OSError, ValueError):
        print(before + printable(words), file=sys.stderr, flush=True)


def require_taken() -> None:
    """At the end of a command: OSError where the standard output did not take everything."""
    try:
        sys.stdout.flush()
    except OSError as error:
        _lost.append(error)
        close_output()
    if _lost and not isinstance(_lost[0], BrokenPipeError):
        raise OSError(_lost[0].errno, _lost[0].strerror, OUTPUT)


def close_output() -> None:
    """Redirect a standard output that has failed to the null device: Python then reports no error at exit."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
