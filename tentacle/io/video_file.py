"""Video as a lab hands it over: one file, or a folder of numbered PNG frames. Found, and tried before it is used."""

from __future__ import annotations

from pathlib import Path

from tentacle.errors import InputError
from tentacle.signals import Video

VIDEO_SUFFIXES = (".mp4", ".mkv", ".avi", ".mov", ".webm")
_PNG_START = b"\x89PNG\r\n\x1a\n"
_PNG_END = b"IEND\xaeB`\x82"


def find_video(folder: Path) -> Video | None:
    """The folder's video, tried; None where there is none. InputError where it is unreadable, or there are two."""
    files = [folder / f"video{suffix}" for suffix in VIDEO_SUFFIXES if (folder / f"video{suffix}").exists()]
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
    """A film in the folder under a name that is not read: the camera's own, or video.MP4; None where there is none."""
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


def check_frames(folder: Path) -> None:
    """InputError where a frame is no whole PNG file."""
    for file in frame_files(folder):
        with file.open("rb") as opened:
            start = opened.read(len(_PNG_START))
            opened.seek(0, 2)
            size = opened.tell()
            opened.seek(max(0, size - len(_PNG_END)))
            end = opened.read()
        if start != _PNG_START:
            raise InputError("not a PNG image", file=file)
        if end != _PNG_END:
            raise InputError("the image is cut off", file=file, expected="a whole PNG file")


def check_video(file: Path) -> None:
    """InputError where a video file cannot be opened or its first frame cannot be decoded."""
    import av  # it takes 0.1 s to import, and most recordings come without a video
    from av.error import FFmpegError

    try:
        with av.open(str(file)) as container:
            if not container.streams.video:
                raise InputError("holds no video", file=file)
            if next(container.decode(video=0), None) is None:
                raise InputError("not one frame can be decoded", file=file)
    except (FFmpegError, OSError) as error:
        raise InputError(
            f"unreadable video: {error.strerror or error}", file=file, expected="a video that FFmpeg reads"
        ) from None
