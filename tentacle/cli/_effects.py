"""The option --effects: laws of effect files beside the catalogue, for one command."""

from __future__ import annotations

import argparse
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any


def add_effects(parser: argparse.ArgumentParser) -> None:
    """The option; tentacle.cli.main reads the files before the verb runs."""
    parser.add_argument(
        "--effects", nargs="+", default=[], type=Path, metavar="FILE.toml",
        help="effect files: their laws are added to the catalogue (docs/howto/law.md)",
    )  # fmt: skip


def effects_in_use(arguments: argparse.Namespace) -> AbstractContextManager[Any]:
    """The context in which the laws of the command's effect files are in use."""
    if not getattr(arguments, "effects", None):
        return nullcontext()
    from affine_model.effects import catalogue
    from tentacle.io.effect_file import effects_of

    return effects_of(arguments.effects, catalogue())
