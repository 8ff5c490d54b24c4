"""A Rerun stream into a file, and the removal of streams that are no longer used."""

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

    Each stream has a thread with a timer, which lives on after its file is closed and its object is gone. At the
    hundredth file of a sweep there would be ninety-nine such threads. They are ended here, as rr.init does.
    """
    rerun_bindings.flush_and_cleanup_orphaned_recordings()
    return rr.RecordingStream(APPLICATION, recording_id=identity, send_properties=send_properties)


@contextmanager
def saved(stream: rr.RecordingStream, file: Path, blueprint: rr.blueprint.Blueprint | None = None) -> Iterator[None]:
    """The data logged inside go into the file. OSError if the disk cannot store all of them."""
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
        with suppress(OSError):  # report the first error
            disk.finish()
        raise
    disk.finish()
