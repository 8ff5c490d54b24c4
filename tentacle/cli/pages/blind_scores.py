"""Scores of a series of blind trials: shares with their intervals, confusion matrix, other methods."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from tentacle.rounding import number
from validation.trials.figures import BASELINE_METHODS, hits
from validation.trials.outcome import Outcome
from validation.trials.scores import VISIBLE, Scores, Share, confusion, share
from viz.figures.confusion import confusion_figure
from viz.report import Picture, ReportSection, ReportTable


def percent(part: Share) -> str:
    """A share in per cent, or "no trial"."""
    return f"{100 * part.value:.0f} %" if part.count else "no trial"


def _row(words: str, part: Share, target: str) -> tuple[str, ...]:
    low, high = part.interval
    return (words, percent(part), f"{100 * low:.0f} to {100 * high:.0f} %", f"{part.hits} of {part.count}", target)


def score_section(found: Scores) -> ReportSection:
    """The table of shares, with the targets."""
    visible = f"R >= {VISIBLE:g}"
    rows = [
        _row(f"single effect, {visible}: named first, or in the named group", found.top1, ">= 95 %"),
        _row(f"single effect, {visible}: named and nothing else", found.exact, ""),
        _row("nothing hidden: something named or unknown (false alarm)", found.false_alarm, "<= 2 %"),
        _row("effect outside the catalogue: called unknown", found.unknown_recall, ">= 95 %"),
        _row(f"pair, both {visible}: both named", found.pairs, ">= 80 %"),
        _row("group where |cos| <= 0.9", found.needless_groups, "0"),
        *(_row(f"single effect, R {_range(low, high)}", part, "") for low, high, part in found.by_r),
        *(_row(f"right, all kinds, seen as {seen}", part, "") for seen, part in found.by_seen),
        *(_row(f"right, all kinds, plant {plant}", part, "") for plant, part in found.by_plant),
    ]
    words = (
        "R is the rms of the residual that refitting the base parameters cannot absorb, in standard deviations of the "
        "noise. A plant is a simulator with its own laws; the plant reference is the chain that the loop uses. "
        "Median time of a diagnosis: "
        f"{number(found.seconds)} s of processor time."
    )
    header = ("trials", "share", "95 % interval", "count", "target")
    return ReportSection("Scores", [words], [ReportTable("Asked and measured", header, rows, numeric=(1, 2, 3))])


def _range(low: float, high: float) -> str:
    return f"{low:g} to {high:g}" if math.isfinite(high) else f"{low:g} or more"


def confusion_section(outcomes: Sequence[Outcome]) -> ReportSection:
    """The confusion matrix of singles, nulls and unknowns."""
    truths, answers, counts = confusion(outcomes)
    if not truths:
        return ReportSection("Confusion matrix", ["No trial has one effect, no effect, or an unknown effect."])
    caption = "Rows: what was hidden; columns: what was answered (a group that holds the truth counts as the truth)."
    words = "Singles of every size, nulls (row: nothing) and effects outside the catalogue (row: unknown)."
    return ReportSection("Confusion matrix", [words], (), [Picture(confusion_figure(truths, answers, counts), caption)])


def baseline_section(outcomes: Sequence[Outcome]) -> ReportSection:
    """The shares of other methods on the same recordings."""
    rows = [("this loop", *_shares(outcomes, lambda o: o.hit and (o.kind != "unknown")))]
    tried = {method for o in outcomes for method in o.baselines}  # a regression on shapes has nothing in markers
    rows += [(words, *_shares(outcomes, hits(method))) for method, words in BASELINE_METHODS if method in tried]
    header = ("method", f"single, R >= {VISIBLE:g}: right", "null: nothing named", "unknown: nothing named")
    words = (
        "The baselines name one effect or no effect, and cannot call an effect unknown. Servo and camera effects are "
        "not among the columns of the regression. Pairs are left out, because no baseline names two effects."
    )
    rows[0] = (*rows[0][:3], percent(share(outcomes, "unknown", lambda o: o.hit)))
    return ReportSection(
        "Other methods on the same recordings", [words], [ReportTable("Share right", header, rows, numeric=(1, 2, 3))]
    )


def _shares(outcomes: Sequence[Outcome], right: Any) -> tuple[str, ...]:
    return (
        percent(share(outcomes, "single", right, VISIBLE)),
        percent(share(outcomes, "null", right)),
        percent(share(outcomes, "unknown", right)),
    )
