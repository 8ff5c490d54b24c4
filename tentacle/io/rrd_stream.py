"""A Rerun stream into a file, and an end to those that nobody holds any more."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from uuid import UUID

import rerun as rr
import rerun_bindings

from tentacle.io.rrd_chunks import FOOTER_END, FOOTER_MAGIC

APPLICATION = "tentacle-twin"
FREE_ROOM = 256 * 1024  # bytes that a disk must still take before a file is begun


def new_stream(identity: str | UUID, *, send_properties: bool = True) -> rr.RecordingStream:
    """A stream of that identity.

    Each stream has a thread that wakes by the clock, and keeps it after its file is closed and its object gone: the
    hundredth file of a sweep would be written beside ninety-nine of them. They are ended here, as rr.init does.
    """
    rerun_bindings.flush_and_cleanup_orphaned_recordings()
    return rr.RecordingStream(APPLICATION, recording_id=identity, send_properties=send_properties)


@contextmanager
def saved(stream: rr.RecordingStream, file: Path, blueprint: rr.blueprint.Blueprint | None = None) -> Iterator[None]:
    """What is logged inside goes into the file. OSError where the disk does not take it to its end."""
    with file.open("wb") as probe:  # Rerun stands still for good where its very first bytes cannot be written
        probe.write(bytes(FREE_ROOM))
        probe.flush()
        os.fsync(probe.fileno())
    try:
        stream.save(file, default_blueprint=blueprint)
        yield
        stream.flush()
        stream.disconnect()
    except RuntimeError as error:
        stream.disconnect()
        if "writer" in str(error) or "write" in str(error):
            raise OSError(errno.ENOSPC, f"cannot be written: {error}", str(file)) from None
        raise
    except BaseException:
        stream.disconnect()
        raise
    with file.open("rb") as opened:  # Rerun tells nobody that a disk was full
        opened.seek(max(0, file.stat().st_size - FOOTER_END))
        if opened.read(len(FOOTER_MAGIC)) != FOOTER_MAGIC:
            raise OSError(errno.ENOSPC, "could not be written to its end (is the disk full?)", str(file))
