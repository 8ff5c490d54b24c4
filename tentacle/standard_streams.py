"""Standard input, output and error of a process that was started without some of them (`>&-`, a service, cron).

The next file that such a process opens would get the missing number, and what is printed would go into that file.
"""

from __future__ import annotations

import os
import sys


def open_standard_streams() -> None:
    """Puts the null device where a standard stream is missing. Call it before anything opens a file that stays open."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free: this one
    if sys.stdin is None:
        sys.stdin = open(0, encoding="utf-8", closefd=False)  # noqa: SIM115 (it stays open)
    if sys.stdout is None:
        sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    if sys.stderr is None:
        sys.stderr = open(2, "w", encoding="utf-8", errors="backslashreplace", closefd=False)  # noqa: SIM115
