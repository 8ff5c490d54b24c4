"""tentacle export: an identified arm in files that another program reads."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from tentacle.cli._output import say

if TYPE_CHECKING:
    from tentacle.model import Model
    from tentacle.recording import Recording

HELP = "write an identified arm for MuJoCo, PyElastica or SoRoMoX, and compare that program with recordings"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument("model", type=Path, metavar="MODEL.toml", help="the model that diagnose or identify wrote")
    parser.add_argument(
        "--to", choices=("mjcf", "urdf", "pyelastica", "soromox"), default="mjcf", help="the program, default: mjcf"
    )
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR",
        help="folder for arm.xml and arm_forces.py, arm.urdf, or a script and arm.json",
    )  # fmt: skip
    parser.add_argument("--links", type=int, metavar="N", help="hinges of a chain, default: 20; not of a script")
    parser.add_argument(
        "--recording", nargs="+", default=[], type=Path, metavar="RECORDING",
        help="run the export under these recordings' base motion, and print its error beside ours",
    )  # fmt: skip
    parser.add_argument(
        "--python", type=Path, metavar="FILE", help="interpreter that has PyElastica or SoRoMoX, default: this one"
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the files, print which effects they have, compare."""
    from tentacle.errors import InputError
    from tentacle.io.model_file import read_model

    model = read_model(arguments.model)
    script = arguments.to in ("pyelastica", "soromox")
    for given, option, where in (
        (script and arguments.links is not None, "--links", "--to mjcf or urdf; the script takes its own on each run"),
        (not script and arguments.python is not None, "--python", "--to pyelastica or soromox"),
    ):
        if given:
            raise InputError(f"does not go with --to {arguments.to}", field=option, expected=where)
    if script:
        return _script(model, arguments)
    links = 20 if arguments.links is None else arguments.links
    return _urdf(model, arguments, links) if arguments.to == "urdf" else _mjcf(model, arguments, links)


def _mjcf(model: Model, arguments: argparse.Namespace, links: int) -> int:
    from mujoco_ref.export.write import write_mjcf
    from validation.export.in_mujoco import export_error

    made = write_mjcf(model, arguments.out, links)
    for sentence in made.carried.sentences():
        say(sentence)
    for recording in _recordings(arguments):
        say(export_error(made.xml, model, recording).sentence())
    say(f"wrote {arguments.out}/arm.xml, arm_forces.py")
    return 0


def _urdf(model: Model, arguments: argparse.Namespace, links: int) -> int:
    from mujoco_ref.export.write import write_urdf
    from tentacle.errors import InputError

    if arguments.recording:
        raise InputError(
            "a URDF has no spring at a joint: it follows no recording", field="--recording", expected="--to mjcf"
        )
    for sentence in write_urdf(model, arguments.out, links).words:
        say(sentence)
    say(f"wrote {arguments.out}/arm.urdf")
    return 0


def _script(model: Model, arguments: argparse.Namespace) -> int:
    from mujoco_ref.export.script import export_script
    from mujoco_ref.export.write import write_script
    from validation.export.in_program import interpreter_with, prepared, script_error

    made = export_script(model, arguments.to)
    asked = arguments.recording or arguments.python
    python = interpreter_with(made.program, arguments.python) if asked else None
    ready = [prepared(model, recording) for recording in _recordings(arguments)]
    files = write_script(made, arguments.out, [one.motion for one in ready])
    for sentence in made.words:
        say(sentence)
    say(f"wrote {arguments.out}/{', '.join(files)}")
    if python is None:
        if asked:
            say(f"{made.program.name} is not installed here: nothing was simulated again; see --python")
        return 0
    for one in ready:
        say(script_error(made, python, one).sentence())
    return 0


def _recordings(arguments: argparse.Namespace) -> list[Recording]:
    from tentacle.cli._progress import reading_plan, stages
    from vision.tracked_recording import read_tracked

    with stages(reading_plan(arguments.recording)) as stage:
        return [read_tracked(path, stage) for path in arguments.recording]
