"""A Rerun stream into a file, and an end to those that nobody holds any more."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from uuid import UUID

import rerun as rr
import rerun_bindings

from tentacle.io.direct_file import way_to_disk

APPLICATION = "tentacle-twin"


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
    disk = way_to_disk(file)
    try:
        try:
            stream.save(disk.entrance, default_blueprint=blueprint)
        finally:
            disk.opened()
        yield
        stream.flush()
        stream.disconnect()
    except BaseException:
        stream.disconnect()
        with suppress(OSError):  # the first error is the one to be told
            disk.finish()
        raise
    disk.finish()
