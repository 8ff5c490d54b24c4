"""A lens as a TOML file, as `tentacle calibrate` writes it and `tentacle track --lens` reads it."""

from __future__ import annotations

from pathlib import Path

from tentacle.io.toml_table import Table, read_toml
from vision.lens import Lens

FARTHEST = 1e6  # px: a picture has at most 16384 a side
MOST_BENT = 100.0  # of k1 and k2: the edge of a picture would lie a hundred times as far out


def read_lens(path: Path) -> Lens:
    """The [lens] table of a file. Raises InputError that names file and field."""
    path = Path(path)
    text, tables = read_toml(path, "a TOML file with [lens]")
    table = Table(tables, file=path, text=text).required_table("lens")
    u, v = table.numbers("centre_px", 2, most=FARTHEST)
    reference = table.number("reference_px", least=1.0, most=FARTHEST)
    k1, k2 = (table.number(name, 0.0, least=-MOST_BENT, most=MOST_BENT) for name in ("k1", "k2"))
    scale = table.number("m_per_px", least=1e-9, most=10.0) if "m_per_px" in table else None
    return Lens((u, v), reference, k1, k2, scale)


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
