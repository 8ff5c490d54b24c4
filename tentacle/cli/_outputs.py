"""The places that a command writes to, by the names of its arguments."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from tentacle.errors import InputError

OUTPUTS = ("out", "csv", "midline", "overlay", "print_board", "screenshot", "sealed", "truth")


def outputs_of(arguments: argparse.Namespace) -> list[Path]:
    """Every file and folder that the arguments name as an output. InputError where two of them are one place."""
    found = {name: getattr(arguments, name, None) for name in OUTPUTS}
    places: dict[str, str] = {}
    for name, place in found.items():
        if isinstance(place, Path):
            other = places.setdefault(os.path.realpath(place), name)
            if other != name:
                words = f"is the place of --{other} too"
                raise InputError(words, file=place, field=f"--{name.replace('_', '-')}", expected="two names")
    return [place for place in found.values() if isinstance(place, Path)]
