"""Measured data of other labs as import folders, one for each run."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from tentacle.errors import InputError
from tentacle.io.pressure_arm import read_pressure_arms
from tentacle.io.silicone_beam import read_beams
from tentacle.io.trunk_payload import read_trunk
from tentacle.io.write_folder import write_folder
from tentacle.recording import Recording

CONVERTED: dict[str, Callable[[Path], Iterator[Recording]]] = {
    "silicone_beam": read_beams,
    "trunk_payload": read_trunk,
    "pressure_arm": read_pressure_arms,
}


def convert_data(name: str, data: Path, out: Path) -> list[Path]:
    """Write a set's runs as import folders under `out`; nothing is written where one of them is there already.

    data: the folder in which the sets lie. Raises InputError where the set is not there, or an output is.
    """
    folder = data / name
    if not folder.is_dir():
        raise InputError("no such data set", file=folder, expected="the folder that `tentacle data` tells of")
    recordings = list(CONVERTED[name](folder))
    for recording in recordings:
        if (out / recording.name).exists():
            raise InputError("is there already", file=out / recording.name, expected="a folder without it")
    return [write_folder(recording, out / recording.name) for recording in recordings]
