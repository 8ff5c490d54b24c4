"""MuJoCo, in a version with which the reference was tested. Its Python module has no types: here it is Any."""

from __future__ import annotations

from typing import Any

import mujoco as _mujoco

REQUIRED = (4, 0)


def require_version(version: str) -> None:
    """ImportError where a MuJoCo of that version string is older than REQUIRED."""
    have = tuple(int("".join(c for c in part if c.isdigit()) or 0) for part in version.split(".")[:2])
    if have < REQUIRED:
        needed = ".".join(map(str, REQUIRED))
        raise ImportError(
            f"mujoco {version} is too old; tentacle-twin needs mujoco >= {needed} (pip install -U mujoco)"
        )


require_version(_mujoco.__version__)
mujoco: Any = _mujoco
