"""Writing frames as a video file (mp4, H.264) whose frames carry their own time stamps, or as a folder of PNGs."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np
from numpy.typing import NDArray

from tentacle.errors import InputError
from tentacle.io.written_file import written_file

TICKS_A_SECOND = 1_000_000  # time stamps to the microsecond


def write_video(path: Path, frames: Iterable[NDArray[np.uint8]], times: Iterable[float], crf: int = 0) -> int:
    """Write grey (H, W) or RGB (H, W, 3) frames with time stamps [s] to path; gives the number of frames.

    A path that ends in .mp4 (.mkv, .avi) is H.264, lossless at crf 0. A path without a suffix is a folder of numbered
    PNGs, which has no times. H.264 needs an even width and height: an odd one repeats its last column or row. A video
    appears under its name only when it is whole. Raises InputError where frames and times differ in number, or times go
    back.
    """
    path = Path(path)
    if path.suffix == "":
        path.mkdir(parents=True, exist_ok=True)
        count = 0
        for count, (frame, _) in enumerate(zip(frames, times, strict=True), start=1):
            cv2.imwrite(str(path / f"{count - 1:05d}.png"), frame if frame.ndim == 2 else frame[:, :, ::-1])
        return count
    partial = path.with_name(path.stem + ".partial" + path.suffix)
    try:
        count = _encode(partial, frames, times, crf)
    except BaseException:
        partial.unlink(missing_ok=True)
        raise
    partial.replace(path)
    return count


def _encode(path: Path, frames: Iterable[NDArray[np.uint8]], times: Iterable[float], crf: int) -> int:
    count, previous = 0, -1
    # The film's beginning is counted in the movie's ticks: in milliseconds, where nobody asks for finer ones.
    names = ("video_track_timescale", "movie_timescale") if path.suffix in (".mp4", ".mov") else ()
    fine = {name: str(TICKS_A_SECOND) for name in names}
    with av.open(str(path), "w", options=fine) as container:
        stream = None
        try:
            for frame, time in zip(frames, times, strict=True):
                ticks = round(float(time) * TICKS_A_SECOND)
                if ticks <= previous:
                    raise InputError(f"time {time} s does not follow the frame before", file=path, row=count + 1)
                previous = ticks
                frame = _even(frame)
                if stream is None:
                    stream = container.add_stream("libx264", rate=Fraction(1000, 1), options=_options(crf))
                    stream.width, stream.height = frame.shape[1], frame.shape[0]
                    stream.pix_fmt = "gray" if frame.ndim == 2 and crf == 0 else "yuv420p"
                    stream.codec_context.time_base = Fraction(1, TICKS_A_SECOND)
                picture = av.VideoFrame.from_ndarray(frame, format="gray" if frame.ndim == 2 else "rgb24")
                picture.pts, picture.time_base = ticks, Fraction(1, TICKS_A_SECOND)
                container.mux(stream.encode(picture))
                count += 1
        except ValueError as error:
            if isinstance(error, InputError):
                raise
            raise InputError("frames and times differ in number", file=path) from error
        if stream is None:
            raise InputError("there are no frames to write", file=path)
        container.mux(stream.encode(None))
    return count


def _options(crf: int) -> dict[str, str]:
    return {"qp": "0", "preset": "ultrafast"} if crf == 0 else {"crf": str(crf), "preset": "veryfast"}


def _even(frame: NDArray[np.uint8]) -> NDArray[np.uint8]:
    rows, columns = frame.shape[0] % 2, frame.shape[1] % 2
    padding = ((0, rows), (0, columns), (0, 0))[: frame.ndim]
    return np.ascontiguousarray(np.pad(frame, padding, mode="edge") if rows or columns else frame)


def write_picture(path: Path, image: NDArray[np.uint8]) -> None:
    """Write a grey or RGB picture; the suffix says how. Raises InputError where it cannot be written."""
    packed = image if image.ndim == 2 else image[:, :, ::-1]
    suffix = Path(path).suffix.lower()
    if suffix not in (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp"):
        raise InputError("the picture cannot be written", file=path, expected="a .png in a folder that exists")
    encoded, content = cv2.imencode(suffix, packed)
    if not encoded or not path.absolute().parent.is_dir():
        raise InputError("the picture cannot be written", file=path, expected="a .png in a folder that exists")
    with written_file(path) as partial:
        partial.write_bytes(content.tobytes())
