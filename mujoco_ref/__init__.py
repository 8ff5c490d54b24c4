"""The high-order reference: a hinge chain in MuJoCo, with water forces, added mass and buoyancy of its own.

It shares words with the reduced model (affine_model) but no equations, so each model checks the other. Importing it
needs MuJoCo 4.0 or later (mujoco_ref.engine).
"""

from mujoco_ref.engine import require_version

__all__ = ["require_version"]
