"""The trials of `tentacle blind-trial --like`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path


def like_recording(
    path: Path, count: int, seed: int, kinds: list[str], real: tuple[bool, list[Path]]
) -> tuple[list, list]:
    """Designs of trials like a recording, and the report's section on what they share with it. real: whether its own
    errors are the noise, and recordings that are the baseline.
    """
    from tentacle.cli._progress import stages
    from tentacle.cli.pages.blind_like import like_section
    from validation.trials.design import designs
    from validation.trials.likeness import RealParts, likeness
    from validation.trials.series import CATALOGUED, UNCATALOGUED
    from validation.trials.sizing import shown_effects
    from vision.tracked_recording import read_tracked

    with stages() as stage:
        recording = read_tracked(path, stage)
        stage(f"fitting the declared model to {recording.name}")
        own, baseline = real
        like = likeness(recording, with_own_errors=own)
        stage("which effects can show in such a recording")
        effects = shown_effects(like, CATALOGUED, UNCATALOGUED)
    silent = sorted({*CATALOGUED, *UNCATALOGUED}.difference(*effects))
    like = replace(
        like, real=RealParts(str(path.resolve()) if own else "", tuple(str(one.resolve()) for one in baseline))
    )
    found = designs(count, seed, *effects, like, kinds)
    return found, [like_section(recording.name, like, effects, silent)]
