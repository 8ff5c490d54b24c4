"""tentacle export: an identified arm in files that another program reads."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from tentacle.cli._output import say

if TYPE_CHECKING:
    from tentacle.model import Model

HELP = "write an identified arm for another program (MuJoCo), and compare that program with recordings"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument("model", type=Path, metavar="MODEL.toml", help="the model that diagnose or identify wrote")
    parser.add_argument("--to", choices=("mjcf", "urdf"), default="mjcf", help="the program's format, default: mjcf")
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="arm.xml and arm_forces.py, or arm.urdf, go there"
    )
    parser.add_argument("--links", type=int, default=20, metavar="N", help="hinges of the chain, default: 20")
    parser.add_argument(
        "--recording", nargs="+", default=[], type=Path, metavar="RECORDING",
        help="run the export under these recordings' base motion, and print its error beside ours",
    )  # fmt: skip


def run(arguments: argparse.Namespace) -> int:
    """Write the files, print which effects they have, compare."""
    from mujoco_ref.export.write import write_mjcf
    from tentacle.cli._progress import reading_plan, stages
    from tentacle.io.model_file import read_model
    from validation.export.in_mujoco import export_error
    from vision.tracked_recording import read_tracked

    model = read_model(arguments.model)
    if arguments.to == "urdf":
        return _urdf(model, arguments)
    made = write_mjcf(model, arguments.out, arguments.links)
    for sentence in made.carried.sentences():
        say(sentence)
    with stages(reading_plan(arguments.recording)) as stage:
        recordings = [read_tracked(path, stage) for path in arguments.recording]
    for recording in recordings:
        say(export_error(made.xml, model, recording).sentence())
    say(f"wrote {arguments.out}/arm.xml, arm_forces.py")
    return 0


def _urdf(model: Model, arguments: argparse.Namespace) -> int:
    from mujoco_ref.export.write import write_urdf
    from tentacle.errors import InputError

    if arguments.recording:
        raise InputError(
            "a URDF has no spring at a joint: it follows no recording", field="--recording", expected="--to mjcf"
        )
    for sentence in write_urdf(model, arguments.out, arguments.links).words:
        say(sentence)
    say(f"wrote {arguments.out}/arm.urdf")
    return 0
