"""The exported arm's files: arm.xml with arm_forces.py as it stands in this project, or arm.urdf."""

from __future__ import annotations

from pathlib import Path

from mujoco_ref.export import arm_forces
from mujoco_ref.export.mjcf import Mjcf, export_mjcf
from mujoco_ref.export.urdf import Urdf, export_urdf
from tentacle.io.result_folder import written
from tentacle.model import Model

ARM, FORCES, URDF = "arm.xml", "arm_forces.py", "arm.urdf"


def write_mjcf(model: Model, out: Path, links: int = 20) -> Mjcf:
    """Write an arm's files into the folder `out`: all of them, or none."""
    made = export_mjcf(model, links)
    with written(out) as folder:
        (folder / ARM).write_text(made.xml, encoding="utf-8")
        (folder / FORCES).write_text(Path(arm_forces.__file__).read_text(encoding="utf-8"), encoding="utf-8")
    return made


def write_urdf(model: Model, out: Path, links: int = 20) -> Urdf:
    """Write arm.urdf into the folder `out`, whole or not at all."""
    made = export_urdf(model, links)
    with written(out) as folder:
        (folder / URDF).write_text(made.text, encoding="utf-8")
    return made
