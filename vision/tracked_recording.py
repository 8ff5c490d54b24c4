"""A recording with its shape seen: read from where it lies, and its video tracked where it has nothing else."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from tentacle.io.reading import read_recording
from tentacle.recording import Recording


def read_tracked(path: Path, stage: Callable[[str], None]) -> Recording:
    """The recording; with a video and neither midline, markers nor track, the video is tracked now."""
    stage(f"reading {path}")
    recording = read_recording(path)
    seen = recording.midline or recording.markers or recording.shape
    if seen is not None or recording.video is None:
        return recording
    from vision.track import track

    count = 0

    def shown(_: object) -> None:
        nonlocal count
        count += 1
        if count % 20 == 0:
            stage(f"tracking {path}: {count} frames")

    shape = track(recording.video.path, recording.declaration, recording.motor, progress=shown)
    return replace(recording, shape=shape)
