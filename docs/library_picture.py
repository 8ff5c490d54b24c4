"""The picture of docs/howto/library.md: python docs/library_picture.py

A library of 200 recordings drawn as in benchmarks/library_joint.py --linear: a current of R = .3 in 20 of them.
"""

from __future__ import annotations

import sys
import tempfile
from datetime import UTC, datetime, timedelta
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "benchmarks"))

from library_joint import DAYS, RECORDINGS, Source, library_of, with_effect  # noqa: E402

from discovery.library.joint import combine  # noqa: E402
from discovery.library.joint_data import joint_data  # noqa: E402
from viz.figures.presence import presence_figure, presence_panel  # noqa: E402

PICTURE = ROOT / "docs" / "pictures" / "library_joint.webp"
FIRST, DPI, QUALITY = datetime(2026, 3, 1, tzinfo=UTC), 170, 88


def main() -> None:
    """Draw it."""
    with tempfile.TemporaryDirectory() as folder:
        recordings = library_of(0, Source(Path(folder), 1, True), with_effect(0))
    names = [f"run {k}" for k in range(RECORDINGS)]
    arm = {"specimen": "14 cm", **joint_data(combine(recordings, DAYS), names)}
    rows = {name: {"date": FIRST + timedelta(days=float(day))} for name, day in zip(names, DAYS, strict=True)}
    figure = presence_figure([presence_panel(arm, effect, rows) for effect in arm["effects"]])
    if figure is None:
        raise SystemExit("no effect was found")
    figure.savefig(PICTURE, dpi=DPI, facecolor="white", pil_kwargs={"quality": QUALITY})


if __name__ == "__main__":
    main()
