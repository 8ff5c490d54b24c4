"""Stills from a camera, as JPEG, made into one video in which each keeps its own time."""

from __future__ import annotations

import io
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import numpy as np

from tentacle.signals import Array

TICK = Fraction(1, 90_000)  # s, of time stamps


def encode_video(times: Array, stills: Sequence[bytes], path: Path) -> None:
    """JPEG pictures at times (N,) >= 0 [s], rising, as H.264."""
    import av  # 0.1 s to import, and only runs with a camera need it

    spacing = float(np.median(np.diff(times))) if len(times) > 1 else 1.0
    with av.open(str(path), mode="w") as container:
        # x264 spends the fewer bits on a frame the more there are a second: by this nominal rate, not by the stamps.
        stream = container.add_stream("libx264", rate=max(round(1.0 / spacing), 1))
        stream.options = {"crf": "10", "preset": "veryfast"}
        stream.codec_context.time_base = stream.time_base = TICK
        for k, (t, data) in enumerate(zip(times.tolist(), stills, strict=True)):
            with av.open(io.BytesIO(data), mode="r", format="mjpeg") as still:
                picture = next(still.decode(video=0)).reformat(format="yuv420p")
            if k == 0:
                stream.width, stream.height, stream.pix_fmt = picture.width, picture.height, "yuv420p"
            picture.pts, picture.time_base = round(t / TICK), TICK
            container.mux(stream.encode(picture))
        container.mux(stream.encode(None))
