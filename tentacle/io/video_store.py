"""A cache for videos from .rrd files, because video readers need a file. The names are hashes of the content.

A file is compared with its name before use. Files unused for a day are deleted if the cache is larger than
TENTACLE_VIDEOS_GB (default 4).
"""

from __future__ import annotations

import hashlib
import os
import shutil
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from tentacle.private_cache import cache_folder

MOST_GB = 4.0
DAY = 86400.0  # s


def store_video(content: bytes, suffix: str) -> Path:
    """A file in the cache with this content; it is written once."""
    digest = hashlib.sha256(content).hexdigest()[:32]
    file = video_folder() / f"{digest}{suffix}"
    if file.is_file() and hashlib.sha256(file.read_bytes()).hexdigest()[:32] == digest:
        os.utime(file)
        return file
    partial = file.with_name(f".{file.name}.{os.getpid()}.partial")
    try:
        partial.write_bytes(content)
        partial.replace(file)
    finally:
        partial.unlink(missing_ok=True)
    return file


def store_frames(frames: Sequence[bytes]) -> Path:
    """A folder of numbered PNG frames in the cache; it is written once."""
    folder = video_folder() / _digest_of(frames)
    if folder.is_dir():
        if _digest_of([file.read_bytes() for file in sorted(folder.glob("*.png"))]) == folder.name:
            os.utime(folder)
            return folder
        shutil.rmtree(folder)
    partial = folder.with_name(f".{folder.name}.{os.getpid()}.partial")
    try:
        partial.mkdir()
        for number, frame in enumerate(frames):
            (partial / f"{number:05d}.png").write_bytes(frame)
        with suppress(FileExistsError):  # another process was quicker, with the same content
            partial.replace(folder)
    finally:
        shutil.rmtree(partial, ignore_errors=True)
    return folder


def _digest_of(frames: Sequence[bytes]) -> str:
    digest = hashlib.sha256()
    for frame in frames:
        digest.update(hashlib.sha256(frame).digest())
    return digest.hexdigest()[:32]


def video_folder() -> Path:
    """The cache's folder, the oldest taken out where it is over its bound."""
    folder = cache_folder("videos")
    entries = [(entry.stat().st_mtime, _size(entry), entry) for entry in folder.iterdir()]
    over = sum(size for _, size, _ in entries) - 1e9 * float(os.environ.get("TENTACLE_VIDEOS_GB") or MOST_GB)
    for used, size, entry in sorted(entries):
        if over <= 0 or time.time() - used < DAY:
            break
        shutil.rmtree(entry) if entry.is_dir() else entry.unlink(missing_ok=True)
        over -= size
    return folder


def _size(entry: Path) -> int:
    """Bytes of a file, or of a folder's files."""
    return sum(file.stat().st_size for file in (entry.iterdir() if entry.is_dir() else (entry,)))
