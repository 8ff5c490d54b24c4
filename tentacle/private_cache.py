"""Folders in the user's cache, private to this user (0700, owner checked), or a temporary one if the cache cannot be
written.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import shutil
import stat
import sys
import tempfile
from functools import cache
from pathlib import Path

from tentacle.errors import InputError

PRIVATE = 0o700
SEAL = 32  # bytes


def cache_folder(name: str, *settings: str) -> Path:
    """The cache folder `name`, made where it is missing.

    It lies in the folder that the first set one of these variables names: settings, TENTACLE_CACHE; else in
    tentacle-twin in the user's cache folder. InputError if it belongs to another user, because its content is executed.
    """
    base = next((found for key in (*settings, "TENTACLE_CACHE") if (found := os.environ.get(key))), None)
    if base is None:
        base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "tentacle-twin"
    return _made(Path(base) / name)


def _seal(file: Path, content: bytes) -> bytes:
    return hashlib.sha256(file.name.encode() + b"\0" + content).digest()


def sealed(file: Path, content: bytes) -> bytes:
    """What to write to a file of the cache: the content, and behind it the SHA-256 of the file's name and content."""
    return content + _seal(file, content)


def unsealed(file: Path) -> bytes | None:
    """The content of a file that was written so; None where it is not there, or torn by a full disk or a power cut."""
    try:
        found = file.read_bytes()
    except OSError:
        return None
    content = found[:-SEAL]
    return content if found[-SEAL:] == _seal(file, content) else None


def _made(folder: Path) -> Path:
    try:
        folder.mkdir(parents=True, exist_ok=True, mode=PRIVATE)
        found = folder.stat()
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        return _temporary(str(folder), error.strerror or str(error))
    if os.name == "posix":
        if found.st_uid != os.geteuid():
            raise InputError("belongs to another user", file=folder, expected="your own folder: set TENTACLE_CACHE")
        if stat.S_IMODE(found.st_mode) != PRIVATE:
            folder.chmod(PRIVATE)
    return folder


@cache
def _temporary(folder: str, reason: str) -> Path:
    """A folder for this process alone."""
    made = Path(tempfile.mkdtemp(prefix="tentacle-"))
    atexit.register(shutil.rmtree, made, ignore_errors=True)
    print(f"tentacle: {folder}: {reason}; nothing is kept for the next run (set TENTACLE_CACHE)", file=sys.stderr)
    return made
