"""Stated confidence and errors of a series of blind trials: the reliability curve, the error before and after."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from discovery.calibration import CONFIDENCE_TEMPERATURE
from validation.trials.outcome import Outcome
from validation.trials.reliability import Bin, calibration_gap
from viz.figures.error_drop import error_drop_figure
from viz.figures.reliability import reliability_figure
from viz.report import Picture, ReportSection, ReportTable


def reliability_section(
    bins: Sequence[Bin], crossed: Sequence[Bin], found: tuple[float, float | None]
) -> ReportSection:
    """The reliability curve; found: the gap by chance alone, and the likeliest temperature of the confidence."""
    by_chance, temperature = found
    if not bins:
        return ReportSection("Is the stated confidence true?", ["No trial."])
    rows = []
    for b in bins:
        interval = f"{b.right.interval[0]:.2f} to {b.right.interval[1]:.2f}"
        row = (f"{b.low:g} to {b.high:g}", f"{b.stated:.3f}", f"{b.right.value:.3f}", interval, str(b.right.count))
        rows.append(row)
    ends = np.array([b.right.interval for b in bins])
    picture = reliability_figure(
        np.array([b.stated for b in bins]), np.array([b.right.value for b in bins]), ends[:, 0], ends[:, 1],
        np.array([b.right.count for b in bins]),
    )  # fmt: skip
    header = ("confidence", "stated", "right", "95 % interval", "trials")
    return ReportSection(
        "Is the stated confidence true?",
        [
            f"Largest gap between stated and right: {100 * calibration_gap(bins):.0f} points (expected by chance if "
            f"every confidence were true: {100 * by_chance:.0f}); with the map of "
            "calibration.toml fitted to one half of these trials and tested on the other, "
            f"{100 * calibration_gap(crossed):.0f} points.",
            f"The loop divides the log odds of the posterior mass by {CONFIDENCE_TEMPERATURE:g}; "
            + (
                "these trials do not determine a better number."
                if temperature is None
                else f"the likeliest number on these trials is {temperature:.2g}."
            ),
        ],
        [ReportTable("Reliability", header, rows, numeric=(1, 2, 3, 4))],
        [
            Picture(
                picture,
                "One point per bin, with its number of trials; on the line the stated confidence equals the hit rate.",
            )
        ],
    )


def blind_error_section(outcomes: Sequence[Outcome]) -> ReportSection:
    """The error before and after of trials with a hidden effect, over the floor."""
    shown = [o for o in outcomes if o.kind in ("single", "pair") and o.floor > 0 and o.before > 0 and o.after > 0]
    if not shown:
        return ReportSection("Error before and after", ["No trial with a hidden effect and a midline."])
    columns = [np.array([getattr(o, name) for o in shown]) for name in ("before", "after", "floor", "hit")]
    caption = (
        "Held-out midline error over its floor (noise and the reduction); solid line: the floor; dotted: 1.2 times it."
    )
    return ReportSection("Error before and after", (), (), [Picture(error_drop_figure(*columns), caption)])
