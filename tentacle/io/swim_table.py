"""A CSV of swimming runs: the columns arm, motion and speed_m_s, one run a row."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from tentacle.errors import InputError
from tentacle.io.plain_file import read_plain
from tentacle.signals import Array


def read_swim_table(file: Path) -> dict[tuple[str, str], Array]:
    """(arm, motion) -> speeds (N,) [m/s] of its runs. InputError names the row and column that cannot be read."""
    try:
        lines = read_plain(file, "a CSV with the columns arm, motion, speed_m_s").decode("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise InputError("not UTF-8 text", file=file, expected="a CSV of text") from None
    runs: dict[tuple[str, str], list[float]] = {}
    for number, row in enumerate(csv.DictReader(lines), start=2):
        for column in ("arm", "motion", "speed_m_s"):
            if not row.get(column):
                raise InputError("missing", file=file, row=number, field=column, expected="a value")
        try:
            runs.setdefault((row["arm"], row["motion"]), []).append(float(row["speed_m_s"]))
        except ValueError:
            raise InputError(
                f"{row['speed_m_s']!r} is no number", file=file, row=number, field="speed_m_s", expected="m/s"
            ) from None
    if not runs:
        raise InputError("has no row", file=file, expected="one run a row")
    return {key: np.array(values) for key, values in runs.items()}
