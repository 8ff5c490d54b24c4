"""A recording with its shapes: read from the disk, with its video tracked if it has no other measurement."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from tentacle.errors import InputError
from tentacle.io.reading import read_recording
from tentacle.progress import Stage
from tentacle.recording import Recording
from tentacle.signals import Video

SHOWN = "--pick, which shows what is found in the film"
LIGHT = 0.5  # share of the tracking time for learning the light, before the first frame's result


def read_tracked(path: Path, stage: Stage) -> Recording:
    """The recording; with a video and neither midline, markers nor track, the video is tracked now."""
    stage(f"reading {path}")
    recording = read_recording(path)
    seen = recording.midline or recording.markers or recording.shape
    if seen is not None or recording.video is None:
        return recording
    from vision.track import track

    told = told_frames(stage, path, recording.video)
    with errors_about(path, recording):
        shape = track(recording.video.path, recording.declaration, recording.motor, progress=told)
    return replace(recording, shape=shape)


@contextmanager
def errors_about(path: Path, recording: Recording) -> Iterator[None]:
    """An InputError about the recording's video names the file or folder that was given: the film of an .rrd lies in a
    cache. Of a plain film it names --pick too.
    """
    try:
        yield
    except InputError as error:
        if recording.video is None or error.file != recording.video.path:
            raise
        expected = ", or ".join(filter(None, [error.expected, SHOWN if path == error.file else ""]))
        raise InputError(error.problem, file=path, row=error.row, field=error.field, expected=expected) from error


def told_frames(stage: Stage, path: Path, video: Video) -> Callable[[object], None]:
    """The callback of tracking at each frame, which shows the share of the frames that is done."""
    from tentacle.io.video_file import count_frames

    stage(f"tracking {path}: the light of the tank")
    count, total = 0, count_frames(video)

    def shown(_: object) -> None:
        nonlocal count
        count += 1
        if count % 20 == 0:
            of = f" of {total}" if total else ""
            stage(f"tracking {path}: {count}{of} frames", LIGHT + (1.0 - LIGHT) * count / total if total else LIGHT)

    return shown
