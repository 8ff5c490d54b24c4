"""The section of a report about the properties that the trials share with the recording."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from tentacle.rounding import number
from validation.trials.design import BASE_SPREAD
from validation.trials.likeness import Likeness
from viz.report import ReportSection, ReportTable
from viz.words import effect_name

SEEN_AS = {
    "midline": "points of the midline",
    "track": "a tracked video (shapes with the tracker's covariance; no video is rendered)",
    "video": "a video, rendered and tracked",
    "markers": "markers",
}


def like_section(
    name: str, like: Likeness, effects: tuple[Sequence[str], Sequence[str]], silent: Sequence[str]
) -> ReportSection:
    """name of the recording; effects that can show in it, in the catalogue and out of it, and silent ones."""
    inside, outside = (", ".join(map(effect_name, names)) for names in effects)
    driven = "the base moves as recorded" if like.release_t is None else "the arm is let go as recorded"
    varied = f"{BASE_SPREAD[0]:g} to {BASE_SPREAD[1]:g} times " * (not like.real.baseline)
    words = [
        f"All trials are runs of the arm of {name}. The base parameters are {varied}those fitted to it without further "
        f"effects; {driven}. Duration, frame rate, kind of measurement and noise are those of the recording.",
        f"Hidden effects of the catalogue: {inside}; outside it: {outside}.",
    ]
    if silent:
        names = ", ".join(map(effect_name, silent))
        words.append(f"Not hidden, because at no strength would they be detected in such a recording: {names}.")
    if like.real.baseline:
        names = ", ".join(Path(path).name for path in like.real.baseline)
        words.append(f"The diagnosis has a real baseline: {names}.")
    words.append(
        "Their noise is what the declared model leaves in the recording, at the same instants: the effects are added "
        "to the real recording. So it has the tracker's bias, the changing light and the errors of the declared laws. "
        "All trials with nothing hidden are this recording."
        if like.real.errors_of
        else "Their noise is white. The recording may also have a tracker's bias, missing frames or "
        "changing light. The trials have none of these, so the confidence does not account for them."
    )
    header = ("what", "value")
    return ReportSection(f"Trials like {name}", words, [ReportTable("Shared by all trials", header, _rows(like))])


def _rows(like: Likeness) -> list[tuple[str, str]]:
    sight = like.sight
    rows = [
        (f"{effect_name(effect)}: {name}", f"{number(estimate.value)} {estimate.unit}".removesuffix(" 1"))
        for effect, values in like.model.parameters.items()
        for name, estimate in values.items()
    ]
    if like.release_t is None:
        angle = np.array(like.motion["angle_rad"])
        rows.append(("base motion", f"the recording's, {number(float(np.ptp(angle)))} rad from end to end"))
    else:
        shape = ", ".join(number(value) for value in like.initial_q or ())
        rows.append(("let go at", f"{number(like.release_t)} s from q = ({shape}) rad"))
    rows += [
        ("length", f"{number(like.duration)} s"),
        ("frames", f"{number(like.fps)} a second"),
        ("seen as", SEEN_AS[sight.kind]),
        ("noise of a coordinate of a point", f"{number(1e3 * sight.noise)} mm"),
    ]
    if sight.angle_noise > 0.0:
        rows.append(("noise of the servo's log", f"{number(1e3 * sight.angle_noise)} mrad"))
    return rows
