"""The origin of a result: versions of the libraries, hashes of the inputs."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from importlib import metadata
from pathlib import Path

LIBRARIES = ("tentacle-twin", "numpy", "scipy", "numba", "mujoco", "opencv-python-headless", "rerun-sdk")


def versions() -> dict[str, str]:
    """Name -> version of the libraries behind a result; a library that is not installed as a package is left out."""
    found = {}
    for name in LIBRARIES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


def input_hashes(paths: Sequence[Path]) -> dict[str, str]:
    """Path -> SHA-256 over the files' names and bytes, a folder's files in the order of their names."""
    return {str(path): _digest(path) for path in paths}


def _digest(path: Path) -> str:
    total = hashlib.sha256()
    files = sorted(file for file in path.rglob("*") if file.is_file()) if path.is_dir() else [path]
    for file in files:
        total.update(file.name.encode())
        with file.open("rb") as stream:
            while block := stream.read(1 << 20):
                total.update(block)
    return total.hexdigest()
