"""numba's njit, with a cache on disk that is checked before it is used.

numba unpickles and runs the files of its cache. A file damaged by a full disk or a power cut would end every later run
with a traceback, or do worse. Here each cache file ends with the SHA-256 of its name and content; one that does not
agree is compiled anew. If the cache cannot be written, the function is compiled in every process. numba checks only the
function's own file for changes, although the compiled code includes functions of other files. Here a change in any file
of the room compiles its functions again.
"""

from __future__ import annotations

import hashlib
import io
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import lru_cache
from pathlib import Path
from typing import Any

import numba
from numba import prange
from numba.core.caching import IndexDataCacheFile
from numba.core.dispatcher import Dispatcher

from tentacle.private_cache import sealed, unsealed

__all__ = ["njit", "prange"]


class CheckedCacheFile(IndexDataCacheFile):
    """numba's index and data files, each with a digest behind what numba reads."""

    @contextmanager
    def _open_for_write(self, filepath: str) -> Iterator[Any]:
        with super()._open_for_write(filepath) as file:
            content = io.BytesIO()
            yield content
            file.write(sealed(Path(filepath), content.getvalue()))

    def _load_index(self) -> dict[Any, str]:
        if unsealed(Path(self._index_path)) is None:
            return {}
        try:
            return super()._load_index()
        except (AttributeError, ImportError):  # a class of another room, which is not there any more
            return {}

    def _load_data(self, name: str) -> Any:
        if unsealed(Path(self._data_path(name))) is None:
            raise OSError("torn")  # numba takes this as: not there
        return super()._load_data(name)

    def save(self, key: Any, data: Any) -> None:
        """Stores the compiled code; a full or read-only disk does not end the run."""
        with suppress(OSError):
            super().save(key, data)


def njit(*, cache: bool = False, **options: Any) -> Callable[[Callable[..., Any]], Any]:
    """numba.njit's decorator; with cache=True the compiled function is kept and checked."""

    def decorate(function: Callable[..., Any]) -> Any:
        compiled: Any = numba.njit(**options)(function)
        if not cache or not isinstance(compiled, Dispatcher):  # NUMBA_DISABLE_JIT leaves the function as it is
            return compiled
        cached: Any = compiled
        with suppress(RuntimeError):  # numba finds no folder to write to
            cached.enable_caching()
            file: Any = cached._cache._cache_file
            file.__class__ = CheckedCacheFile
            file._version = (file._version, room_digest(Path(function.__code__.co_filename).parent))
        return cached

    return decorate


@lru_cache
def room_digest(folder: Path) -> str:
    """SHA-256 of a room's files; empty for a folder that is not a room, whose files are independent."""
    if not (folder / "__init__.py").exists():
        return ""
    files = sorted(folder.glob("*.py"))
    return hashlib.sha256(b"\0".join(file.name.encode() + b"\0" + file.read_bytes() for file in files)).hexdigest()
