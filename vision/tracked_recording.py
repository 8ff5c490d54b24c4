"""A recording with its shape seen: read from where it lies, and its video tracked where it has nothing else."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from tentacle.io.reading import read_recording
from tentacle.progress import Stage
from tentacle.recording import Recording

LIGHT = 0.5  # of the time that tracking takes goes into learning the light, before the first frame is told


def read_tracked(path: Path, stage: Stage) -> Recording:
    """The recording; with a video and neither midline, markers nor track, the video is tracked now."""
    stage(f"reading {path}")
    recording = read_recording(path)
    seen = recording.midline or recording.markers or recording.shape
    if seen is not None or recording.video is None:
        return recording
    from tentacle.io.video_file import count_frames
    from vision.track import track

    stage(f"tracking {path}: the light of the tank")
    count, total = 0, count_frames(recording.video)

    def shown(_: object) -> None:
        nonlocal count
        count += 1
        if count % 20 == 0:
            of = f" of {total}" if total else ""
            stage(f"tracking {path}: {count}{of} frames", LIGHT + (1.0 - LIGHT) * count / total if total else LIGHT)

    shape = track(recording.video.path, recording.declaration, recording.motor, progress=shown)
    return replace(recording, shape=shape)
