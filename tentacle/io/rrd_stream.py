"""A Rerun stream into a file, and an end to those that nobody holds any more."""

from __future__ import annotations

import errno
from pathlib import Path
from uuid import UUID

import rerun as rr
import rerun_bindings

from tentacle.io.rrd_chunks import FOOTER_END, FOOTER_MAGIC

APPLICATION = "tentacle-twin"


def new_stream(identity: str | UUID, *, send_properties: bool = True) -> rr.RecordingStream:
    """A stream of that identity.

    Each stream has a thread that wakes by the clock, and keeps it after its file is closed and its object gone: the
    hundredth file of a sweep would be written beside ninety-nine of them. They are ended here, as rr.init does.
    """
    rerun_bindings.flush_and_cleanup_orphaned_recordings()
    return rr.RecordingStream(APPLICATION, recording_id=identity, send_properties=send_properties)


def require_whole(file: Path) -> None:
    """OSError where a file that was closed has no footer: Rerun tells nobody that a disk was full."""
    with file.open("rb") as opened:
        opened.seek(max(0, file.stat().st_size - FOOTER_END))
        if opened.read(len(FOOTER_MAGIC)) != FOOTER_MAGIC:
            raise OSError(errno.ENOSPC, "could not be written to its end (is the disk full?)", str(file))
