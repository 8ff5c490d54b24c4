"""Reading frames, grey and 8 bit: a video with each frame's own time stamp (PyAV), or a folder of numbered pictures."""

from __future__ import annotations

import time
from collections.abc import Generator, Iterator
from contextlib import closing, nullcontext
from dataclasses import dataclass
from pathlib import Path

import av
import cv2
import numpy as np
from av.container import InputContainer
from av.error import FFmpegError
from av.video.frame import VideoFrame
from av.video.stream import VideoStream
from numpy.typing import NDArray

from tentacle.errors import InputError
from tentacle.io.plain_file import require_plain
from tentacle.io.video_file import check_png

Grey = NDArray[np.uint8]
# do not read seconds of the stream before the first frame: in a growing file this would reach the end of the file
AT_ONCE = {"analyzeduration": "0", "fpsprobesize": "0"}
POLL = 0.01  # s between looks at a file that grows
PICTURES = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp")


@dataclass(frozen=True)
class Frame:
    """One picture: its time stamp t [s] and its grey levels image (height, width)."""

    t: float
    image: Grey


def read_frames(path: Path, fps: float | None = None, patience: float = 0.0) -> Generator[Frame, None, None]:
    """Yield the frames of a video, or of a folder of numbered pictures (then frame k is at k / fps).

    A camera device (/dev/video0) is a video without an end, its times from its first frame. patience [s]: for a file
    that is still being written (mkv, ts, avi: formats without an index): the end is reached if nothing comes for that
    long. Colour becomes luma, 16 bit becomes 8, an alpha channel is put over black, and a declared rotation is applied.
    A truncated video gives the frames before the break. Raises InputError where nothing can be read: no such file, an
    empty one, no video in it, an unknown codec, a folder without pictures or without fps.
    """
    path = Path(path)
    if path.is_dir():
        yield from _read_folder(path, fps)
        return
    if path.is_char_device():
        yield from _read_video(path, patience)
        return
    if not path.is_file():
        raise InputError("there is no such file", file=path, expected="a video or a folder of pictures")
    if path.stat().st_size == 0 and not patience:
        raise InputError("the file is empty", file=path, expected="a video")
    count = 0
    for frame in _read_video(path, patience):
        count += 1
        yield frame
    if count == 0:
        raise InputError("no frame can be decoded", file=path, expected="a video with at least one frame")


class _Growing:
    """A file that is still being written: reading waits for more, up to patience [s] (the interface PyAV asks for)."""

    def __init__(self, path: Path, patience: float) -> None:
        self._file, self._patience, self._over = path.open("rb"), patience, False

    def read(self, size: int) -> bytes:
        """Up to size bytes; none if nothing comes during patience, and none after that."""
        waited = 0.0
        while not (data := self._file.read(size)) and not self._over:
            time.sleep(POLL)
            waited += POLL
            self._over = waited >= self._patience
        return b"" if self._over else data

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def _read_video(path: Path, patience: float) -> Iterator[Frame]:
    device = path.is_char_device()
    with closing(_Growing(path, patience)) if patience and not device else nullcontext(str(path)) as source:
        try:
            options = AT_ONCE if patience else {}
            container = av.open(source, mode="r", format="v4l2" if device else None, options=options)
        except (FFmpegError, ValueError) as error:
            raise InputError("it is not a video that can be read", file=path, expected="mp4, mkv, avi, webm") from error
        with container:
            yield from _stamped(container, path, device)


def _stamped(container: InputContainer, path: Path, device: bool) -> Iterator[Frame]:
    """Frames with their times [s]; a camera's times count from its first frame, because its clock started with the
    machine.
    """
    if not container.streams.video:
        raise InputError("there is no video stream in it", file=path, expected="a video")
    stream = container.streams.video[0]
    if stream.codec_context is None:
        raise InputError("its codec is not known", file=path, expected="H.264, HEVC, AV1, VP9, FFV1, MJPEG")
    stream.thread_type = "AUTO"
    last, first = -np.inf, None
    for picture in _pictures(container, stream):
        stamp = picture.time
        if stamp is None or stamp <= last:  # a frame without a usable stamp is useless
            continue
        last = float(stamp)
        if first is None:
            first = last if device else 0.0
        yield Frame(last - first, _luma(picture))


def _pictures(container: InputContainer, stream: VideoStream) -> Iterator[VideoFrame]:
    """The decoded pictures; a broken packet loses its own pictures, and a truncated file those after the break."""
    packets = container.demux(stream)
    while True:
        try:
            packet = next(packets)
        except (StopIteration, FFmpegError):
            break
        try:
            yield from packet.decode()
        except FFmpegError:
            continue
    try:
        yield from stream.codec_context.decode(None)  # pictures still in the decoder's threads
    except (FFmpegError, EOFError):
        return


def _luma(picture: VideoFrame) -> Grey:
    """The luma plane if there is one (its range does not matter for edges), rotated as declared."""
    if picture.format.name.startswith(("yuv420p", "yuv422p", "yuv444p", "yuvj", "gray", "nv12")) and (
        picture.format.components[0].bits == 8
    ):
        plane = picture.planes[0]
        rows = np.asarray(memoryview(plane), dtype=np.uint8).reshape(-1, plane.line_size)  # pyright: ignore[reportArgumentType]
        grey = rows[: picture.height, : picture.width]
    elif any(component.is_alpha for component in picture.format.components):
        grey = _over_black(np.asarray(picture.to_ndarray(format="bgra"), dtype=np.uint8))
    else:
        grey = np.asarray(picture.to_ndarray(format="gray"), dtype=np.uint8)
    turns = round(picture.rotation / 90) % 4
    return np.ascontiguousarray(np.rot90(grey, turns)) if turns else np.ascontiguousarray(grey)


def _read_folder(path: Path, fps: float | None) -> Iterator[Frame]:
    files = sorted(file for file in path.iterdir() if file.suffix.lower() in PICTURES)
    if not files:
        raise InputError("there are no pictures in the folder", file=path, expected="00000.png, 00001.png, ...")
    if fps is None or not (np.isfinite(fps) and fps > 0):
        raise InputError("a folder of pictures has no times", file=path, field="fps", expected="a positive frame rate")
    for index, file in enumerate(files):
        yield Frame(index / fps, read_picture(file))


def read_picture(path: Path) -> Grey:
    """One picture as grey, 8 bit. Raises InputError where it cannot be read."""
    require_plain(path, "a PNG, JPEG, TIFF or BMP")
    content = path.read_bytes()
    if path.suffix.lower() == ".png":
        check_png(content, path)
    try:
        picture = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED) if content else None
    except cv2.error:  # too large, for one
        picture = None
    if picture is None:
        raise InputError("the picture cannot be read", file=path, expected="a PNG, JPEG, TIFF or BMP")
    if picture.dtype == np.uint16:
        picture = (picture / 257.0 + 0.5).astype(np.uint8)
    elif picture.dtype != np.uint8:
        raise InputError(f"{picture.dtype} pixels are not known", file=path, expected="8 or 16 bit")
    if picture.ndim == 3 and picture.shape[2] in (2, 4):
        return _over_black(np.asarray(picture, dtype=np.uint8))
    if picture.ndim == 3:
        picture = cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY) if picture.shape[2] == 3 else picture[:, :, 0]
    return np.ascontiguousarray(picture, dtype=np.uint8)


def _over_black(picture: Grey) -> Grey:
    """Grey of a picture (H, W, 2 or 4) whose last channel is its opacity, over black."""
    alpha = picture[:, :, -1:].astype(float) / 255.0
    shown = np.rint(picture[:, :, :-1] * alpha).astype(np.uint8)
    grey = cv2.cvtColor(shown, cv2.COLOR_BGR2GRAY) if shown.shape[2] == 3 else shown[:, :, 0]
    return np.ascontiguousarray(grey, dtype=np.uint8)
