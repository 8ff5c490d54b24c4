"""A lab's video: one file, or a folder of numbered PNG frames. It is found and tested before use."""

from __future__ import annotations

import os
import struct
import zlib
from contextlib import suppress
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tentacle.errors import InputError
from tentacle.io.plain_file import is_there, require_plain
from tentacle.signals import Video

LARGEST_SIDE = 16384  # px
VIDEO_SUFFIXES = (".mp4", ".mkv", ".avi", ".mov", ".webm", ".gif")
_PNG_START = b"\x89PNG\r\n\x1a\n"
_PNG_END = b"IEND\xaeB`\x82"


def find_video(folder: Path) -> Video | None:
    """The folder's video, tried; None where there is none. InputError where it is unreadable, or there are two."""
    files = [folder / f"video{suffix}" for suffix in VIDEO_SUFFIXES if os.path.lexists(folder / f"video{suffix}")]
    frames = folder / "frames"
    if frames.is_dir():
        files.append(frames)
    if len(files) > 1:
        raise InputError(f"both {files[0].name} and {files[1].name}", file=folder, expected="one video")
    if not files:
        return None
    (check_frames if files[0] == frames else check_video)(files[0])
    return Video(files[0])


def frame_files(folder: Path) -> list[Path]:
    """The frames' files in order: 00000.png and on. InputError where one is missing or there is none."""
    files = sorted(folder.glob("*.png"))
    if not files:
        raise InputError("no frame", file=folder, expected="00000.png, 00001.png, ...")
    for number, file in enumerate(files):
        if file.stem != f"{number:05d}":
            missing = folder / f"{number:05d}.png"
            raise InputError(
                f"missing, and there is {file.name}", file=missing, expected="frames numbered without a gap"
            )
    return files


def misnamed_video(folder: Path) -> Path | None:
    """A film in the folder with a wrong name, such as the camera's own or video.MP4; None if there is none."""
    films = [file for file in sorted(folder.iterdir()) if file.is_file() and file.suffix.lower() in VIDEO_SUFFIXES]
    return films[0] if films else None


def count_frames(video: Video) -> int:
    """About how many frames there are, from the file's own header; 0 where it does not say."""
    if video.path.is_dir():
        return len(frame_files(video.path))
    import av

    with av.open(str(video.path)) as container:
        stream = container.streams.video[0]
        if stream.frames:
            return stream.frames
        rate = float(stream.average_rate or 0)
        return round(rate * container.duration / av.time_base) if container.duration else 0


def frame_rate(file: Path) -> float:
    """Pictures a second on average, as the film's header says; 30 where it does not say."""
    import av

    with av.open(str(file)) as container:
        return float(container.streams.video[0].average_rate or 30.0)


def frame_stamps(file: Path) -> NDArray[np.int64]:
    """Times [ns] at which the film's pictures are shown, in order; empty where FFmpeg reads none.

    Rerun's own reader of MP4 stands still at some damaged ones, and nothing can interrupt it.
    """
    import av
    from av.error import FFmpegError

    stamps: list[int] = []
    with suppress(FFmpegError, IndexError), av.open(str(file)) as container:
        stream = container.streams.video[0]
        for packet in container.demux(stream):
            if packet.pts is not None and packet.time_base is not None:
                stamps.append(round(packet.pts * packet.time_base * 10**9))
    return np.array(sorted(stamps), dtype=np.int64)


def check_frames(folder: Path) -> None:
    """InputError where a frame is no whole PNG file."""
    for file in frame_files(folder):
        check_png(file.read_bytes() if is_there(file) else b"", file)


def check_png(data: bytes, file: Path) -> None:
    """InputError where a PNG is cut off, damaged (its own checksums say so), or of a size that no camera has."""
    if not data.startswith(_PNG_START):
        raise InputError("not a PNG image", file=file)
    if not data.endswith(_PNG_END):
        raise InputError("the image is cut off", file=file, expected="a whole PNG file")
    at = len(_PNG_START)
    while at + 12 <= len(data):
        (length,) = struct.unpack_from(">I", data, at)
        body = data[at + 4 : at + 8 + length]
        if len(data) < at + 12 + length or zlib.crc32(body) != struct.unpack_from(">I", data, at + 8 + length)[0]:
            raise InputError("the image is damaged", file=file, expected="a PNG file as it was written")
        if body[:4] == b"IHDR":
            width, height = struct.unpack_from(">II", body, 4)
            require_size(width, height, file)
        at += 12 + length


def require_size(width: int, height: int, file: Path) -> None:
    """InputError for a picture that no camera takes: decoded it would fill the memory."""
    if not (0 < width <= LARGEST_SIDE and 0 < height <= LARGEST_SIDE):
        raise InputError(f"{width} x {height} pixels", file=file, expected=f"at most {LARGEST_SIDE} a side")


def check_video(file: Path) -> None:
    """InputError where a video file cannot be opened or its first frame cannot be decoded."""
    import av  # it takes 0.1 s to import, and most recordings come without a video
    from av.error import FFmpegError

    require_plain(file, "a video")
    try:
        with av.open(str(file)) as container:
            if not container.streams.video:
                raise InputError("holds no video", file=file)
            stream = container.streams.video[0]
            if stream.codec_context is None:
                raise InputError("its codec is not known", file=file, expected="a video that FFmpeg reads")
            require_size(stream.codec_context.width, stream.codec_context.height, file)
            if next(container.decode(video=0), None) is None:
                raise InputError("not one frame can be decoded", file=file)
    except (FFmpegError, OSError) as error:
        raise InputError(
            f"unreadable video: {error.strerror or error}", file=file, expected="a video that FFmpeg reads"
        ) from None
