"""The option --effects: laws of effect files beside the catalogue, for one command."""

from __future__ import annotations

import argparse
from pathlib import Path


def add_effects(parser: argparse.ArgumentParser) -> None:
    """The option; tentacle.cli.main reads the files before the verb runs."""
    parser.add_argument(
        "--effects", nargs="+", default=[], type=Path, metavar="FILE.toml",
        help="effect files, whose laws act beside the catalogue (docs/howto/law.md)",
    )  # fmt: skip
