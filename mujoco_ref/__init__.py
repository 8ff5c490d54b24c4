"""The high-order reference: a hinge chain in MuJoCo, with water forces, added mass and buoyancy of its own.

It shares words with the reduced model (affine_model), never equations: they are each other's check. Importing it needs
MuJoCo 4.0 or later, whose interface and Coriolis terms it is tested against.
"""

from __future__ import annotations

import mujoco

REQUIRED_MUJOCO = (4, 0)


def require_version(version: str) -> None:
    """ImportError where a MuJoCo of that version string is older than REQUIRED_MUJOCO."""
    have = tuple(int("".join(c for c in part if c.isdigit()) or 0) for part in version.split(".")[:2])
    if have < REQUIRED_MUJOCO:
        needed = ".".join(map(str, REQUIRED_MUJOCO))
        raise ImportError(
            f"mujoco {version} is too old; tentacle-twin needs mujoco >= {needed} (pip install -U mujoco)"
        )


require_version(mujoco.__version__)
