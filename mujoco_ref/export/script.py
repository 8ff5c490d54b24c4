"""An identified arm as a script of another rod's program: PyElastica or SoRoMoX.

A script is one file of this project, as it stands, beneath a heading that says what it carries of this arm. It reads
arm.json (mujoco_ref.export.arm_numbers) and needs its program alone.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from mujoco_ref.export.arm_numbers import arm_numbers
from mujoco_ref.export.carried import NOT_IN_THE_ARM, refuse_clamp
from tentacle.errors import InputError
from tentacle.model import Model

ARM_NUMBERS = "arm.json"
# Effect -> how both scripts carry it.
CARRIES = {
    "inertia": "the rod's own mass",
    "weight": "a force along the rod",
    "elasticity": "bending stiffness along the rod",
    "damping": "bending damping along the rod",
    "third_curvature": "the rod's own shapes",
    "buoyancy": "density, a force along the rod",
    "gravity_tilt": "direction of gravity",
    "tip_mass": "a body on its lever at the tip",
    "payload_place": "that body's lever",
    "soft_spot": "bending stiffness along the rod",
    "cubic_stiffness": "moment with the cube of the bend",
    "intrinsic_curvature": "curvature at rest",
    "amplitude_damping": "damping with the square of the bend",
    "drag": "a force along the rod",
    "skin_drag": "a force along the rod",
    "linear_drag": "a force along the rod",
    "added_mass": "mass across the rod, with its convective terms",
    "current": "speed relative to the water",
    "sloshing": "speed relative to the water, its acceleration",
}


@dataclass(frozen=True)
class Program:
    """A program that a script is for: its name for people, the module that must be importable, the script's file, and
    how its rod differs from the identified arm.
    """

    name: str
    module: str
    script: str
    difference: str


PROGRAMS: Mapping[str, Program] = {
    "pyelastica": Program("PyElastica", "elastica", "arm_pyelastica.py", "its rod also shears, and stretches a little"),
    "soromox": Program("SoRoMoX", "soromox", "arm_soromox.py", "it bends in as many curvatures as the model"),
}


@dataclass(frozen=True)
class Script:
    """The text of a script and of arm.json; words: one line for what is carried, one for each effect that is not."""

    program: Program
    text: str
    numbers: dict[str, Any]
    words: tuple[str, ...]

    def write(self, folder: Path) -> None:
        """Both files into a folder."""
        (folder / self.program.script).write_text(self.text, encoding="utf-8")
        (folder / ARM_NUMBERS).write_text(json.dumps(self.numbers, indent=1) + "\n", encoding="utf-8")


def export_script(model: Model, to: str) -> Script:
    """The arm of a model for PROGRAMS[to]. InputError where the reference refuses the model, or its clamp gives."""
    refuse_clamp(model)
    if to not in PROGRAMS:
        raise InputError(f"{to!r} is not known", field="--to", expected=", ".join(PROGRAMS))
    program = PROGRAMS[to]
    names = list(dict.fromkeys(("inertia", "weight", *model.parameters)))
    kept = replace(model, parameters={name: own for name, own in model.parameters.items() if name in CARRIES})
    carried = ", ".join(f"{name} ({CARRIES[name]})" for name in names if name in CARRIES)
    words = [
        f"{program.script} carries: {carried}.",
        f"{program.script} differs from the model: {program.difference}.",
        *(
            f"{program.script} leaves out {name}: {NOT_IN_THE_ARM.get(name, 'the script has no law for it')}."
            for name in names
            if name not in CARRIES
        ),
    ]
    source = Path(__file__).with_name(program.script).read_text(encoding="utf-8")
    heading = "# An arm identified by tentacle.\n" + "".join(f"# {line}\n" for line in words)
    return Script(program, heading + source, arm_numbers(kept), tuple(words))
