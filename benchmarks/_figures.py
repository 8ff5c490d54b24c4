"""The figures of a benchmark: printed, and kept for docs/figures.json."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path


def tell(found: Mapping[str, float], file: Path | None) -> None:
    """A line for each figure; file: where they are kept as JSON (None: nowhere)."""
    for name, value in found.items():
        print(f"{name}: {value:.4g}")
    if file is not None:
        file.write_text(json.dumps({"figures": found}, indent=1) + "\n")
