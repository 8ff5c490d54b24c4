"""Words for an error: what the system says of a file, the first line of a text, where a trace was put."""

from __future__ import annotations

import os
import re
import sys
import tempfile
import traceback
from pathlib import Path

from tentacle.errors import printable


def os_words(error: OSError) -> str:
    """The file and what the system says of it; of two, the one that was written. What is not finished yet goes by the
    name that it was to have.
    """
    name = error.filename2 or error.filename or ("the standard output" if _output_failed() else "")
    where = re.sub(r"\.([^/]+)\.partial-\w+", r"\1", f"{name}: ") if name else ""
    return printable(f"{where}{error.strerror or first_line(error)}")


def _output_failed() -> bool:
    """Whether the standard output takes nothing: what it did not take is still waiting."""
    try:
        sys.stdout.flush()
    except (OSError, ValueError):
        return True
    return False


def first_line(error: BaseException) -> str:
    """The kind of an error and the first line of its text."""
    text = str(error).strip().splitlines()
    return printable(f"{type(error).__name__}: {text[0][:200]}" if text else type(error).__name__)


def trace_of(error: BaseException) -> Path | str:
    """Where the trace of a defect was put."""
    if os.environ.get("TENTACLE_TRACE"):
        traceback.print_exception(error)
        return "the lines above"
    try:
        handle, name = tempfile.mkstemp(prefix="tentacle-defect-", suffix=".txt")
        with os.fdopen(handle, "w", encoding="utf-8", errors="backslashreplace") as file:
            traceback.print_exception(error, file=file)
    except OSError:
        return "nowhere: no file can be written"
    return Path(name)
