"""A Rerun stream into a file, and an end to those that nobody holds any more."""

from __future__ import annotations

from uuid import UUID

import rerun as rr
import rerun_bindings

APPLICATION = "tentacle-twin"


def new_stream(identity: str | UUID, *, send_properties: bool = True) -> rr.RecordingStream:
    """A stream of that identity.

    Each stream has a thread that wakes by the clock, and keeps it after its file is closed and its object gone: the
    hundredth file of a sweep would be written beside ninety-nine of them. They are ended here, as rr.init does.
    """
    rerun_bindings.flush_and_cleanup_orphaned_recordings()
    return rr.RecordingStream(APPLICATION, recording_id=identity, send_properties=send_properties)
