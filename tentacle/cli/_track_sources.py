"""tentacle track of several videos at once, and of a video whose arm is still to be found (--pick)."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from tentacle.cli._output import cell, say, show

if TYPE_CHECKING:
    from vision.declared import DeclaredNumbers


def several(sources: list[Path], arguments: argparse.Namespace) -> int:
    """All of them, in parallel; one table. 1 where one failed."""
    from rich.table import Table

    from tentacle.errors import InputError
    from vision.batch import SUMMARY_COLUMNS, TrackingBatch, track_all

    for name in ("overlay", "midline", "paper", "live", "pick", "reject", "accept"):
        if getattr(arguments, name):
            raise InputError("is for one video", field=f"--{name}", expected="one video at a time")
    if arguments.out is None or arguments.out.suffix:
        raise InputError("of several videos the results go to a folder", field="--out", expected="a folder")
    rows = track_all(
        sources,
        TrackingBatch(stated_numbers(arguments), arguments.order, arguments.lens, arguments.out),
        arguments.workers,
    )
    table = Table(*SUMMARY_COLUMNS)
    for row in rows:
        shown = {**row, "source": Path(row["source"]).name}
        table.add_row(*(cell(str(shown[name])) for name in SUMMARY_COLUMNS))
    show(table)
    say(f"wrote {arguments.out / 'summary.csv'}")
    return int(any(row["problem"] for row in rows))


def picked_recording(video: Path, arguments: argparse.Namespace) -> Path:
    """The recording that --pick makes of a plain video, once a person has looked at it."""
    import sys

    from tentacle.errors import InputError
    from vision.declared import is_recording
    from vision.pick import pick, write_pick

    if is_recording(video):
        raise InputError("is a recording already", file=video, field="--pick", expected="a plain video")
    numbers = stated_numbers(arguments)
    while True:
        picked = pick(video, numbers)
        found, camera = picked.proposal, picked.declaration.camera
        assert camera is not None
        say(
            f"base ({found.base_px[0]:.0f}, {found.base_px[1]:.0f}) px, tip ({found.tip_px[0]:.0f},"
            f" {found.tip_px[1]:.0f}) px, {found.length_px:.0f} px long, {found.width_px[0]:.1f} to"
            f" {found.width_px[1]:.1f} px wide, {'dark' if found.polarity > 0 else 'light'};"
            f" {camera.metres_per_px:.4g} m per px"
        )
        for words in (*found.words, *found.doubts):
            say(words)
        say(f"look at {picked.picture}")
        if arguments.yes or not sys.stdin.isatty():
            break
        answer = input("take it? [Enter: yes, n: no, or U V: the base in the picture] ").split()
        if not answer or answer[0].lower() in ("y", "yes"):
            break
        try:
            u, v = (float(word) for word in answer)
        except ValueError:
            raise InputError("not taken", field="--pick", expected="yes, or two numbers") from None
        arguments.base_px = (u, v)
        numbers = stated_numbers(arguments)
    home = write_pick(video, picked)
    say(f"wrote {home / 'recording.toml'}")
    return home


def stated_numbers(arguments: argparse.Namespace) -> DeclaredNumbers:
    """What the options state of a plain video."""
    from vision.declared import DeclaredNumbers

    return DeclaredNumbers(
        arguments.length,
        arguments.base_radius,
        arguments.tip_radius,
        None if arguments.base_px is None else (arguments.base_px[0], arguments.base_px[1]),
        arguments.m_per_px,
        arguments.fps,
        arguments.exposure,
        arguments.live,
    )
