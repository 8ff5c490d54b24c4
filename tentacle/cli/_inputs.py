"""The recordings that a command reads: none of them twice, and advice about each."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from tentacle.cli._output import remark
from tentacle.errors import InputError

if TYPE_CHECKING:
    from tentacle.recording import Recording


def require_once(groups: Mapping[str, Sequence[Path]]) -> None:
    """InputError where a recording is given twice, in one group (name of the argument -> its paths) or in two.

    A recording that is its own baseline or its own check would answer for itself.
    """
    given: dict[str, str] = {}
    for name, paths in groups.items():
        for path in paths:
            place = os.path.realpath(path)
            if place in given:
                words = "is given twice" if given[place] == name else f"is given as {given[place]} too"
                raise InputError(words, file=path, field=name, expected="each recording once")
            given[place] = name


def tell_advice(recordings: Sequence[Recording]) -> None:
    """A line on standard error for each slip that an unusual set-up could explain, as `tentacle import` prints it."""
    from tentacle.slips import find_slips

    for recording in recordings:
        for slip in find_slips(recording):
            remark(f"{recording.name}/{slip.line()}", "check: ")
