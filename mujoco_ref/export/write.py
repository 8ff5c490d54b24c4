"""The exported arm's files: arm.xml with arm_forces.py as it stands in this project, arm.urdf, or a script with its
numbers.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mujoco_ref.export import arm_forces
from mujoco_ref.export.mjcf import Mjcf, export_mjcf
from mujoco_ref.export.script import ARM_NUMBERS, Script
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


def write_script(made: Script, out: Path, motions: Sequence[dict[str, Any]] = ()) -> list[str]:
    """Write a script, its numbers and recordings' motions into the folder `out`, all or none; the files' names."""
    names = [f"motion_{k}.json" if k > 1 else "motion.json" for k in range(1, len(motions) + 1)]
    with written(out) as folder:
        made.write(folder)
        for name, motion in zip(names, motions, strict=True):
            (folder / name).write_text(json.dumps(motion) + "\n", encoding="utf-8")
    return [made.program.script, ARM_NUMBERS, *names]
