"""Limits of the numbers of a command line: finite, and of a size that a computer can handle."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import Any

from tentacle.errors import InputError

LARGEST_NUMBER = 1e9
LARGEST_SEED = 2**63 - 1
# Option -> least and most. The most is what a patient user may still want, not what is sensible.
BOUNDS: dict[str, tuple[float, float]] = {
    "seed": (0, LARGEST_SEED),
    "seeds": (0, LARGEST_SEED),
    "links": (2, 1000),
    "size": (16, 8192),
    "duration": (0, 86400),
    "seconds": (0, 86400),
    "fps": (1e-4, 10_000),
    "frames": (1, 1_000_000),
    "noise_mm": (0, 1000),
    "evaluations": (1, 100_000_000),
    "robust": (0, 10_000),
    "restarts": (1, 10_000),
    "bootstrap": (0, 1_000_000),
    "workers": (1, 1024),
    "trials": (1, 1_000_000),
    "count": (1, 1_000_000),
    "only": (0, 1_000_000),
    "amplitude": (-1000, 1000),
    "exposure": (0, 1000),
    "compress": (0, 51),
    "harmonics": (0, 20),
    "reidentify": (0, 1_000_000),
    "across": (2, 100),
    "down": (2, 100),
    "square": (1e-5, 10),
    "marker": (1e-5, 10),
    "rate": (1e-3, 1000),
}
POSITIONAL_NAMES = {"count": "N"}  # arguments without dashes, as --help calls them
MOST_SAMPLES = 20_000_000  # frames, or evaluations of the base motion


def require_sane(arguments: argparse.Namespace) -> None:
    """InputError at the first number that is not finite, or beyond its bounds, and at a name that is no UTF-8: no
    report, table or declaration could hold it.
    """
    for name, value in vars(arguments).items():
        for number in value if isinstance(value, list | tuple) else (value,):
            if isinstance(number, str | Path) and not str(number).isprintable():
                _require_utf8(str(number))
            if isinstance(number, int | float) and not isinstance(number, bool):
                _require(name, number)
    duration = getattr(arguments, "duration", None) or getattr(arguments, "seconds", None)
    fps = getattr(arguments, "fps", None)
    if duration is not None and fps is not None and duration * fps > MOST_SAMPLES:
        raise InputError(f"{duration * fps:.3g} frames", field="--fps", expected=f"at most {MOST_SAMPLES}")


def _require_utf8(text: str) -> None:
    try:
        text.encode()
    except UnicodeEncodeError:
        raise InputError("is no UTF-8", file=text, expected="a name in UTF-8") from None


def _require(name: str, number: Any) -> None:
    least, most = BOUNDS.get(name, (-LARGEST_NUMBER, LARGEST_NUMBER))
    field = POSITIONAL_NAMES.get(name, f"--{name.replace('_', '-')}")
    if isinstance(number, float) and not math.isfinite(number):
        raise InputError(f"{number} is not usable", field=field, expected="a finite number")
    if not least <= number <= most:
        shown = str(number) if isinstance(number, float) or abs(number) < 1e15 else "a huge number"
        expected = f"{least:g} to {most:g}"
        raise InputError(f"{shown} is not usable", field=field, expected=expected)
