"""A camera's video made small for the viewer."""

from __future__ import annotations

import io
import os
import sys
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest

from tentacle.recording import Camera
from tentacle.signals import Video
from viz.priority import thread_policies
from viz.video import VIDEO_TIME_BASE, frames, small_video


def filmed_unevenly(file: Path, t: np.ndarray) -> Path:
    """A film of grey pictures at the times t [s], each its own grey."""
    with av.open(str(file), "w") as container:
        stream = container.add_stream("libx264", rate=30)
        stream.width, stream.height, stream.pix_fmt = 64, 48, "yuv420p"
        stream.codec_context.time_base = Fraction(1, VIDEO_TIME_BASE)
        for number, instant in enumerate(t):
            frame = av.VideoFrame.from_ndarray(np.full((48, 64, 3), 4 * number, np.uint8), "rgb24")
            frame.pts, frame.time_base = round(instant * VIDEO_TIME_BASE), Fraction(1, VIDEO_TIME_BASE)
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
    return file


def recording_filmed_unevenly(case, folder, t):
    camera = Camera(30.0, 1e-3, (32.0, 4.0), (0.0, 1.0))
    declaration = replace(case.recordings[0].declaration, camera=camera)
    return replace(case.recordings[0], declaration=declaration, video=Video(filmed_unevenly(folder / "uneven.mp4", t)))


def test_frames_that_come_unevenly_keep_their_times(case, tmp_path):
    """A camera at 30 frames/s on a busy computer: two frames in one thirtieth of a second, and then none."""
    t = np.arange(40) / 30 + np.random.default_rng(1).uniform(-0.015, 0.015, 40) + 0.02
    small = small_video(recording_filmed_unevenly(case, tmp_path, t))
    with av.open(io.BytesIO(small.contents)) as container:
        shown = [float(frame.time) for frame in container.decode(video=0) if frame.time is not None]
    assert np.allclose(np.diff(small.t), np.diff(t), rtol=0, atol=1 / VIDEO_TIME_BASE)  # the file's own resolution
    assert np.allclose(shown, small.t, rtol=0, atol=1 / VIDEO_TIME_BASE)


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux's root lets the encoder raise priorities")
@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root may have real-time threads")
def test_no_thread_is_left_a_real_time_one(case, tmp_path, monkeypatch):
    """The encoder makes itself and its caller real-time threads, which stop all else on the machine."""
    seen, mine = [], os.sched_getscheduler(0)

    def watched(recording):
        for given in frames(recording):
            yield given
            seen.append(set(thread_policies().values()))  # the encoder is at work

    monkeypatch.setattr("viz.video.frames", watched)
    small_video(recording_filmed_unevenly(case, tmp_path, np.arange(40) / 30))
    seen.append(set(thread_policies().values()))
    assert all(policies == {mine} for policies in seen)
