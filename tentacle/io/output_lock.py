"""One command for each output: a second one with the same --out is refused in one line, before it computes.

A lock is a file in a private folder beside other temporary files, named by a hash of the output's path, so that
nothing is left beside the output. It ends with its process in every case. A command of another user, or on another
computer, is not seen; those are kept apart while they write (tentacle.io.result_folder). Without a temporary folder
there is no lock.
"""

from __future__ import annotations

import hashlib
import os
import stat
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from tentacle.errors import InputError
from tentacle.io.folder_lock import held


@contextmanager
def owned_outputs(outputs: Iterable[Path]) -> Iterator[None]:
    """Holds a lock for each output, files and folders alike. InputError where another process has one of them."""
    places = {os.path.realpath(output): output for output in outputs}
    with ExitStack() as held:
        if (folder := _folder_of_locks()) is not None:
            for place, output in places.items():
                held.enter_context(_owned(folder / hashlib.sha256(os.fsencode(place)).hexdigest()[:32], output))
        yield


@contextmanager
def _owned(lock: Path, output: Path) -> Iterator[None]:
    try:
        file = lock.open("a")
    except OSError:
        yield
        return
    expected = "another output, or wait until that command has ended"
    with held(file, InputError("is in use by another command", file=output, expected=expected)):
        yield


def _folder_of_locks() -> Path | None:
    """A folder of this user alone; None where it cannot be made, or belongs to somebody else."""
    user = str(os.getuid()) if os.name == "posix" else os.environ.get("USERNAME", "user")
    try:
        folder = Path(tempfile.gettempdir()) / f"tentacle-locks-{user}"
        folder.mkdir(mode=0o700, exist_ok=True)
        found = folder.lstat()
    except OSError:
        return None
    return folder if stat.S_ISDIR(found.st_mode) and (os.name != "posix" or found.st_uid == os.getuid()) else None
