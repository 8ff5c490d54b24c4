"""tentacle reproduce: the paper's tables and figures on the MuJoCo reference in place of the tank; one file each
beside this."""

from __future__ import annotations

import argparse
from importlib import import_module
from pathlib import Path

HELP = "reproduce a table or figure of the paper; the MuJoCo reference replaces the tank"
MODULE_PREFIX = "_reproduce_"


def paper_results() -> list[str]:
    """What can be reproduced, found by listing this folder."""
    return sorted(file.stem.removeprefix(MODULE_PREFIX) for file in Path(__file__).parent.glob(f"{MODULE_PREFIX}*.py"))


def configure(parser: argparse.ArgumentParser) -> None:
    """A sub-command a result."""
    choices = parser.add_subparsers(title="results", metavar="RESULT", required=True)
    for name in paper_results():
        module = import_module(f"tentacle.cli.{MODULE_PREFIX}{name}")
        choice = choices.add_parser(name, help=module.HELP, description=module.HELP, allow_abbrev=False)
        module.configure(choice)
        choice.set_defaults(reproduce=module.run)


def run(arguments: argparse.Namespace) -> int:
    """Hand over to the result's own file."""
    return arguments.reproduce(arguments)
