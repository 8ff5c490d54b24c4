"""A CSV of what sensors on the arm read: t_s, then one column for each sensor; a blank cell means: not measured."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tentacle.errors import InputError
from tentacle.io.csv_table import read_csv, write_csv
from tentacle.io.plain_file import is_there
from tentacle.signals import Array


def read_readings(
    file: Path, section: tuple[str, str, str], columns: dict[str, float], expected: str
) -> tuple[Array, Array] | None:
    """Times (T,) and values (T, G) of the columns, each with its largest value; None where there is no such file and
    no sensor is declared.

    section: the table of recording.toml, what it declares, and its form. expected: what a value is.
    """
    name, sensors, form = section
    if not is_there(file):
        if columns:
            raise InputError(f"no such file, and [{name}] declares {sensors}", file=file)
        return None
    if not columns:
        toml = file.parent / "recording.toml"
        raise InputError(f"missing, and there is {file.name}", file=toml, field=name, expected=form)
    table = read_csv(file, ("t_s", *columns), blank_allowed=True)
    table.require_values("t_s")
    table.require_rising("t_s")
    for column, most in columns.items():
        table.require_within(column, most, expected)
    return table["t_s"], np.stack([table[column] for column in columns], axis=-1)


def write_readings(file: Path, t: Array, columns: tuple[str, ...], values: Array) -> None:
    """The CSV that read_readings gives back."""
    write_csv(file, {"t_s": t, **{column: values[:, k] for k, column in enumerate(columns)}})
