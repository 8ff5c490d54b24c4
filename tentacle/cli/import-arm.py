"""tentacle import-arm: an arm from another program's MJCF as a model of this one."""

from __future__ import annotations

import argparse
from pathlib import Path

from tentacle.cli._output import say

HELP = "read an arm from an MJCF file (a chain of hinges with springs) into a model.toml"


def configure(parser: argparse.ArgumentParser) -> None:
    """The verb's arguments."""
    parser.add_argument("arm", type=Path, metavar="ARM.xml", help="a straight, planar chain of hinges")
    parser.add_argument("--out", type=Path, required=True, metavar="MODEL.toml", help="the model to write")
    parser.add_argument("--fluid", type=float, metavar="KG/M3", help="density of the fluid, default: the file's own")


def run(arguments: argparse.Namespace) -> int:
    """Read, write, and print how the file was read."""
    from mujoco_ref.export.imported import import_arm
    from tentacle.errors import InputError
    from tentacle.io.model_file import write_model

    if arguments.out.suffix != ".toml":
        raise InputError("is no name of a model", file=arguments.out, field="--out", expected="MODEL.toml")
    if not arguments.out.parent.is_dir():
        raise InputError("no such folder", file=arguments.out.parent, field="--out")
    found = import_arm(arguments.arm, arguments.fluid)
    write_model(found.model, arguments.out)
    for sentence in found.words:
        say(sentence)
    say(f"wrote {arguments.out}")
    return 0
