"""Makes one video of JPEG pictures from a camera; each picture keeps its own time."""

from __future__ import annotations

import io
from collections.abc import Iterable
from fractions import Fraction
from itertools import chain, islice
from pathlib import Path

import numpy as np

TICK = Fraction(1, 90_000)  # s, of time stamps
FIRST = 30  # frames whose spacing tells the rate


def encode_video(stills: Iterable[tuple[float, bytes]], path: Path) -> int:
    """Times >= 0 [s] and JPEG pictures as H.264, one at a time; how many. A time that does not rise is left out."""
    import av  # 0.1 s to import, and only runs with a camera need it
    from av.error import FFmpegError

    rest = iter(stills)
    head = list(islice(rest, FIRST))
    if not head:
        return 0
    spacing = float(np.median(np.diff([t for t, _ in head]))) if len(head) > 1 else 1.0
    count, last = 0, -1
    with av.open(str(path), mode="w") as container:
        # x264 uses fewer bits for a frame at a higher frame rate; it goes by this nominal rate, not by the stamps.
        stream = container.add_stream("libx264", rate=min(max(round(1.0 / max(spacing, 1e-3)), 1), 1000))
        stream.options = {"crf": "10", "preset": "veryfast"}
        stream.codec_context.time_base = stream.time_base = TICK
        for t, data in chain(head, rest):
            if round(t / TICK) <= last:
                continue
            try:
                with av.open(io.BytesIO(data), mode="r", format="mjpeg") as still:
                    picture = next(still.decode(video=0)).reformat(format="yuv420p")
            except (FFmpegError, StopIteration):
                continue  # a camera sends a torn picture now and then
            if not count:
                stream.width, stream.height, stream.pix_fmt = picture.width, picture.height, "yuv420p"
            picture.pts = last = round(t / TICK)
            picture.time_base = TICK
            container.mux(stream.encode(picture))
            count += 1
        if count:
            container.mux(stream.encode(None))
    return count
