"""Where a video that came inside an .rrd is put, since readers of video want a file: a cache named by content."""

from __future__ import annotations

import hashlib
import os
import shutil
from collections.abc import Sequence
from pathlib import Path


def cache_folder() -> Path:
    """$TENTACLE_CACHE, or tentacle-twin in the user's cache folder; made where it is missing."""
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    folder = Path(os.environ.get("TENTACLE_CACHE") or Path(base) / "tentacle-twin")
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def store_video(content: bytes, suffix: str) -> Path:
    """A file in the cache with this content; it is written once."""
    file = cache_folder() / f"{hashlib.sha256(content).hexdigest()[:32]}{suffix}"
    if not file.exists():
        partial = file.with_name(f".{file.name}.{os.getpid()}.partial")
        partial.write_bytes(content)
        partial.replace(file)
    return file


def store_frames(frames: Sequence[bytes]) -> Path:
    """A folder of numbered PNG frames in the cache; it is written once."""
    digest = hashlib.sha256()
    for frame in frames:
        digest.update(hashlib.sha256(frame).digest())
    folder = cache_folder() / digest.hexdigest()[:32]
    if not folder.exists():
        partial = folder.with_name(f".{folder.name}.{os.getpid()}.partial")
        partial.mkdir()
        for number, frame in enumerate(frames):
            (partial / f"{number:05d}.png").write_bytes(frame)
        try:
            partial.replace(folder)
        except OSError:  # another process was quicker, with the same content
            shutil.rmtree(partial)
    return folder
