"""A camera's video made small for the viewer."""

from __future__ import annotations

import io
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import av
import numpy as np

from tentacle.recording import Camera
from tentacle.signals import Video
from viz.video import TICKS, small_video


def filmed_unevenly(file: Path, t: np.ndarray) -> Path:
    """A film of grey pictures at the times t [s], each its own grey."""
    with av.open(str(file), "w") as container:
        stream = container.add_stream("libx264", rate=30)
        stream.width, stream.height, stream.pix_fmt = 64, 48, "yuv420p"
        stream.codec_context.time_base = Fraction(1, TICKS)
        for number, instant in enumerate(t):
            frame = av.VideoFrame.from_ndarray(np.full((48, 64, 3), 4 * number, np.uint8), "rgb24")
            frame.pts, frame.time_base = round(instant * TICKS), Fraction(1, TICKS)
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
    return file


def test_frames_that_come_unevenly_keep_their_times(case, tmp_path):
    """A camera at 30 frames/s on a busy computer: two frames in one thirtieth of a second, and then none."""
    t = np.arange(40) / 30 + np.random.default_rng(1).uniform(-0.015, 0.015, 40) + 0.02
    camera = Camera(30.0, 1e-3, (32.0, 4.0), (0.0, 1.0))
    declaration = replace(case.recordings[0].declaration, camera=camera)
    video = Video(filmed_unevenly(tmp_path / "uneven.mp4", t))
    small = small_video(replace(case.recordings[0], declaration=declaration, video=video))
    with av.open(io.BytesIO(small.contents)) as container:
        shown = [float(frame.time) for frame in container.decode(video=0) if frame.time is not None]
    assert np.allclose(np.diff(small.t), np.diff(t), rtol=0, atol=1 / TICKS)  # the file's own resolution
    assert np.allclose(shown, small.t, rtol=0, atol=1 / TICKS)
