"""A camera recording made small for the viewer: AV1 (plays without ffmpeg), at most 640 px wide, keyed often."""

from __future__ import annotations

import io
import os
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import av
import av.error
import av.video.frame
import numpy as np

from tentacle.errors import InputError
from tentacle.recording import Recording
from tentacle.signals import Array
from viz.priority import kept_priority

MAXIMUM_WIDTH = 640
KEY_FRAME_EVERY = 30
QUALITY = 38  # SVT-AV1 crf: about 40 kB a second for a dark arm on a light ground at 640 x 360
VIDEO_TIME_BASE = 90_000  # time base [1/s]

os.environ.setdefault("SVT_LOG", "1")  # the encoder prints a page per file otherwise; 1 leaves its errors


@dataclass(frozen=True)
class SmallVideo:
    """An mp4 in memory, its frame times (T,) [s] in the recording's time, and its pixels per camera pixel."""

    contents: bytes
    t: Array
    scale: float
    width: int
    height: int


def frames(recording: Recording) -> Iterator[tuple[float, av.VideoFrame]]:
    """(time [s], frame) of a recording's video: each frame's own time stamp, or k / fps for a folder of pictures.

    A video that breaks off gives what stands before the break. Raises InputError where nothing can be read.
    """
    if recording.video is None or recording.declaration.camera is None:
        raise InputError("no video with a declared camera", field="video", expected="a recording that has both")
    path = Path(recording.video.path)
    if path.is_dir():
        for index, picture in enumerate(sorted(path.glob("*.png"))):
            with av.open(str(picture)) as container:
                yield index / recording.declaration.camera.fps, next(container.decode(video=0))
        return
    started = False
    try:
        with av.open(str(path)) as container:
            for frame in container.decode(video=0):
                if frame.time is not None:
                    yield float(frame.time), frame
                    started = True
    except (OSError, av.error.FFmpegError) as error:
        if not started:
            raise InputError(f"cannot be read as a video ({error})", file=path, expected="a video") from None


def upright(frame: av.VideoFrame) -> av.VideoFrame:
    """The frame turned as its file declares (a camera held sideways); unchanged where it declares nothing."""
    turns = round(frame.rotation / 90) % 4
    if turns == 0:
        return frame
    turned = np.rot90(frame.to_ndarray(format="rgb24").astype(np.uint8), turns)
    return av.VideoFrame.from_ndarray(np.ascontiguousarray(turned), "rgb24")


def even(value: float) -> int:
    """The nearest even number of at least 2: AV1's 4:2:0 needs even sides."""
    return max(2, 2 * round(value / 2))


def small_video(recording: Recording) -> SmallVideo:
    """The recording's video, scaled down and encoded as AV1; the same input gives the same bytes."""
    times: list[float] = []
    size = (0, 0)
    scale = 1.0
    target = io.BytesIO()
    with av.open(target, "w", format="mp4") as container:
        stream = container.add_stream("libsvtav1", rate=30)
        stream.options = {"preset": "10", "crf": str(QUALITY), "g": str(KEY_FRAME_EVERY), "svtav1-params": "lp=1"}
        stream.pix_fmt = "yuv420p"
        stream.codec_context.time_base = Fraction(1, VIDEO_TIME_BASE)  # else 1 / rate, and uneven frames collide
        for t, seen in frames(recording):
            frame = upright(seen)
            if not times:
                scale = min(1.0, MAXIMUM_WIDTH / frame.width)
                size = (even(frame.width * scale), even(frame.height * scale))
                stream.width, stream.height = size
                with kept_priority():
                    stream.codec_context.open()
            ticks = round(t * VIDEO_TIME_BASE)
            if times and ticks <= round(times[-1] * VIDEO_TIME_BASE):
                continue  # a duplicated frame: the mp4 needs rising times, and the viewer shows the earlier one
            small = frame.reformat(*size, format="yuv420p")
            small.pts, small.time_base = ticks, Fraction(1, VIDEO_TIME_BASE)
            small.pict_type = av.video.frame.PictureType.NONE
            container.mux(stream.encode(small))
            times.append(t)
        container.mux(stream.encode())
    if not times:
        raise InputError("has no frames", file=recording.video.path if recording.video else None, expected="a video")
    return SmallVideo(target.getvalue(), np.array(times), scale, *size)
