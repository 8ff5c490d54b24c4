"""Python's compiled modules (`__pycache__/*.pyc`): none is written to a disk that may not take it whole; torn ones go.

Python 3.11 puts a compiled module in its place without asking how many bytes of it the disk took. A torn one then
breaks every later run with "marshal data too short".
"""

from __future__ import annotations

import marshal
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

LEAST_FREE = 64 * 2**20  # bytes; all compiled modules of an environment take less than half of it
HEADER = 16  # bytes before the code
CODE_READER = "_compile_bytecode"  # the function of importlib that reads the code, into whose frame we look
ROOMS = ("affine_model", "discovery", "inference", "mujoco_ref", "rig", "tentacle", "validation", "vision", "viz")


def write_no_torn_modules() -> None:
    """Python writes no compiled modules from now on if the disk is nearly full, or the size of files is limited."""
    places = [Path(__file__).parent, Path(sys.prefix)]
    if any(_room(place) < LEAST_FREE for place in places):
        sys.dont_write_bytecode = True


def _room(place: Path) -> float:
    """Bytes that a file in a folder may have."""
    try:
        free = float(shutil.disk_usage(place).free)
    except OSError:
        return 0.0
    if sys.platform == "win32":
        return free
    import resource

    limit = resource.getrlimit(resource.RLIMIT_FSIZE)[0]
    return free if limit == resource.RLIM_INFINITY else min(free, limit)


def torn_module(error: BaseException | None) -> Path | None:
    """The compiled module whose reading raised an error, or an error that led to it; None for any other error."""
    while error is not None:
        trace = error.__traceback__
        while trace is not None:
            if trace.tb_frame.f_code.co_name == CODE_READER and trace.tb_next is None:
                return Path(str(trace.tb_frame.f_locals["bytecode_path"]))
            trace = trace.tb_next
        error = error.__cause__ or error.__context__
    return None


def remove_torn_modules(found: Path) -> str:
    """Removes a torn compiled module and those torn beside it (Python makes them again), and says so in a line."""
    torn = {found, *(file for top in _beside(found) for file in top.rglob("__pycache__/*.pyc") if _is_torn(file))}
    try:
        for file in torn:
            file.unlink(missing_ok=True)
    except OSError as failed:
        return f"{failed.filename}: a compiled module is torn and cannot be removed: {failed.strerror}"
    return f"{found}: a compiled module was torn; {len(torn)} such files are removed; run the command again"


def _beside(found: Path) -> Iterator[Path]:
    """The package of a compiled module; where it is one of ours, all of ours."""
    package = found.parent.parent
    while (package.parent / "__init__.py").is_file():
        package = package.parent
    yield from (package.parent / room for room in ROOMS) if package.name in ROOMS else [package]


def _is_torn(file: Path) -> bool:
    try:
        marshal.loads(file.read_bytes()[HEADER:])  # Python would execute it: nothing more is trusted here
    except (EOFError, ValueError, TypeError):
        return True
    except OSError:
        return False
    return False
