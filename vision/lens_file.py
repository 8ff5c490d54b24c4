"""A lens as a TOML file, as `tentacle calibrate` writes it and `tentacle track --lens` reads it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from tentacle.errors import InputError
from tentacle.io.toml_table import read_toml
from vision.lens import Lens


def read_lens(path: Path) -> Lens:
    """The [lens] table of a file. Raises InputError that names file and field."""
    path = Path(path)
    _, tables = read_toml(path, "a TOML file with [lens]")
    table = tables.get("lens")
    if not isinstance(table, dict):
        raise InputError("there is no [lens]", file=path, expected="a file of tentacle calibrate")
    centre = table.get("centre_px")
    if not (isinstance(centre, list) and len(centre) == 2):
        raise InputError(f"{centre!r} is not usable", file=path, field="centre_px", expected="[u, v]")
    u, v = (_number({"centre_px": value}, "centre_px", path) for value in centre)
    reference = _number(table, "reference_px", path)
    scale = None if table.get("m_per_px") is None else _number(table, "m_per_px", path)
    if reference <= 0 or (scale is not None and scale <= 0):
        raise InputError("must be above zero", file=path, field="reference_px, m_per_px", expected="positive numbers")
    k1, k2 = (_number({"k": table.get(name, 0.0)}, "k", path) for name in ("k1", "k2"))
    return Lens((u, v), reference, k1, k2, scale)


def _number(table: dict[str, Any], name: str, path: Path) -> float:
    value = table.get(name)
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < math.inf:
        raise InputError(f"{value!r} is not usable", file=path, field=name, expected="a number")
    return float(value)


def format_lens(lens: Lens, **remarks: float) -> str:
    """The file's text with all digits; remarks are further numbers for the reader."""
    lines = [
        "[lens]",
        f"centre_px = [{lens.centre[0]!r}, {lens.centre[1]!r}]",
        f"reference_px = {lens.reference!r}",
        f"k1 = {lens.k1!r}",
        f"k2 = {lens.k2!r}",
    ]
    if lens.metres_per_px is not None:
        lines.append(f"m_per_px = {lens.metres_per_px!r}")
    lines += [f"{name} = {value!r}" for name, value in remarks.items()]
    return "\n".join(lines) + "\n"
