"""A file that Rerun writes itself, where the system has no /dev/fd by which it could write into a pipe (Windows).

Rerun does not report a full disk. It writes a footer last, so a file without a footer is incomplete.
"""

from __future__ import annotations

import errno
import time
from pathlib import Path

from tentacle.io.disk_pipe import ENTRANCES, DiskPipe
from tentacle.io.rrd_chunks import has_footer

END_WITHIN = 3.0  # s for Rerun to write the footer after it was closed
LOOK_AGAIN = 0.01  # s


class DirectFile:
    """As DiskPipe, but a full disk is known only at the end. OSError where the file cannot be opened."""

    def __init__(self, file: Path) -> None:
        file.open("wb").close()
        self._file = file

    @property
    def entrance(self) -> str:
        """The path under which a writer opens the file."""
        return str(self._file)

    def opened(self) -> None:
        """Nothing: this holds no end of a pipe."""

    def settle(self, within: float) -> None:
        """Nothing: what Rerun has flushed is in the file, or is found missing at its end."""

    def finish(self) -> None:
        """After its writer was closed. OSError where the file has no end."""
        end = time.monotonic() + END_WITHIN
        while not has_footer(self._file):
            if time.monotonic() > end:
                raise OSError(errno.ENOSPC, "was not written to its end; the disk may be full", str(self._file))
            time.sleep(LOOK_AGAIN)

    def abandon(self) -> None:
        """Nothing: nobody else waits for the disk."""


def way_to_disk(file: Path) -> DiskPipe | DirectFile:
    """Through a pipe where the system can. OSError where the file cannot be opened."""
    return DiskPipe(file) if ENTRANCES.is_dir() else DirectFile(file)
