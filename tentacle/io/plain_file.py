"""Opens plain files only: a broken link, a pipe, a device or a folder is reported, and the program never waits
for it.
"""

from __future__ import annotations

import os
import stat
from pathlib import Path

from tentacle.errors import InputError

LARGEST_TEXT = 2**30  # bytes of a table or a declaration


def is_there(file: Path) -> bool:
    """Whether a plain file lies there; False where nothing does. InputError for anything else."""
    if not os.path.lexists(file):
        return False
    require_plain(file)
    return True


def require_plain(file: Path, expected: str | None = None) -> None:
    """InputError where there is no plain file, or a link leads nowhere."""
    try:
        mode = file.stat().st_mode
    except FileNotFoundError:
        if file.is_symlink():
            target = str(file.readlink())
            annexed = " (its content is not here: git annex get)" if "annex" in target else ""
            raise InputError(f"a link to {target}, which is not there{annexed}", file=file, expected=expected) from None
        raise InputError("no such file", file=file, expected=expected) from None
    except (OSError, ValueError) as error:  # a name with a zero in it is a ValueError
        problem = getattr(error, "strerror", None) or str(error)
        raise InputError(f"cannot be read: {problem}", file=file, expected=expected) from None
    kinds = {stat.S_IFDIR: "a folder", stat.S_IFIFO: "a pipe", stat.S_IFCHR: "a device", stat.S_IFBLK: "a device",
             stat.S_IFSOCK: "a socket"}  # fmt: skip
    kind = kinds.get(stat.S_IFMT(mode))
    if kind is not None:
        raise InputError(f"is {kind}", file=file, expected=expected or "a plain file")


def read_plain(file: Path, expected: str | None = None) -> bytes:
    """A plain file's content, of a size that a text can have."""
    require_plain(file, expected)
    try:
        size = file.stat().st_size
        if size > LARGEST_TEXT:
            raise InputError("is over a gigabyte", file=file, expected=expected or "a text")
        return file.read_bytes() if size else b""  # files of /proc have no size, and some of them wait for ever
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", file=file, expected=expected) from None
