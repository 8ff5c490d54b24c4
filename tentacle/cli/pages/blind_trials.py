"""The report of a series of blind trials."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from discovery.calibration import CONFIDENCE_TEMPERATURE
from validation.trials.figures import BASELINE_METHODS, hits
from validation.trials.outcome import Outcome
from validation.trials.reliability import (
    Bin,
    calibration_gap,
    cross_calibrated,
    fit_temperature,
    gap_by_chance,
    reliability,
)
from validation.trials.scores import VISIBLE, Scores, Share, confusion, scores, share
from viz.figures.confusion import confusion_figure
from viz.figures.error_drop import error_drop_figure
from viz.figures.reliability import reliability_figure
from viz.report import Origin, Picture, Report, ReportSection, ReportTable, render_report
from viz.words import effect_name, number


def blind_trials_page(
    outcomes: Sequence[Outcome],
    refused: Sequence[tuple[int, str]],
    origin: Origin,
    before: Sequence[ReportSection] = (),
) -> str:
    """report.html as text; before: sections ahead of the scores."""
    found = scores(outcomes)
    headline = (
        f"{len(outcomes)} recordings with hidden effects, diagnosed without the answer: of single effects with "
        f"R >= {VISIBLE:g} {_percent(found.top1)} named first or in the group; false alarms on nulls "
        f"{_percent(found.false_alarm)}; effects outside the catalogue called unknown "
        f"{_percent(found.unknown_recall)}; both of a pair {_percent(found.pairs)}."
    )
    crossed = reliability(cross_calibrated(outcomes))
    sections = [
        *before,
        _score_section(found),
        _confusion_section(outcomes),
        _reliability_section(reliability(outcomes), crossed, (gap_by_chance(outcomes), fit_temperature(outcomes))),
        _error_section(outcomes),
        _baseline_section(outcomes),
        _trial_section(outcomes, refused),
    ]
    merits = [
        ("top-1", _percent(found.top1)),
        ("false alarms", _percent(found.false_alarm)),
        ("unknown recall", _percent(found.unknown_recall)),
        ("after / floor", number(found.after_over_floor)),
    ]
    return render_report(Report("blind-trial", "Blind trials", headline, sections, origin, merits))


def _percent(part: Share) -> str:
    return f"{100 * part.value:.0f} %" if part.count else "no trial"


def _row(words: str, part: Share, target: str) -> tuple[str, ...]:
    low, high = part.interval
    return (words, _percent(part), f"{100 * low:.0f} to {100 * high:.0f} %", f"{part.hits} of {part.count}", target)


def _score_section(found: Scores) -> ReportSection:
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
    return f"{low:g} to {high:g}" if np.isfinite(high) else f"{low:g} or more"


def _confusion_section(outcomes: Sequence[Outcome]) -> ReportSection:
    truths, answers, counts = confusion(outcomes)
    if not truths:
        return ReportSection("Confusion matrix", ["No trial has one effect, no effect, or an unknown effect."])
    caption = "Rows: what was hidden; columns: what was answered (a group that holds the truth counts as the truth)."
    words = "Singles of every size, nulls (row: nothing) and effects outside the catalogue (row: unknown)."
    return ReportSection("Confusion matrix", [words], (), [Picture(confusion_figure(truths, answers, counts), caption)])


def _reliability_section(
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


def _error_section(outcomes: Sequence[Outcome]) -> ReportSection:
    shown = [o for o in outcomes if o.kind in ("single", "pair") and o.floor > 0 and o.before > 0 and o.after > 0]
    if not shown:
        return ReportSection("Error before and after", ["No trial with a hidden effect and a midline."])
    columns = [np.array([getattr(o, name) for o in shown]) for name in ("before", "after", "floor", "hit")]
    caption = (
        "Held-out midline error over its floor (noise and the reduction); solid line: the floor; dotted: 1.2 times it."
    )
    return ReportSection("Error before and after", (), (), [Picture(error_drop_figure(*columns), caption)])


def _baseline_section(outcomes: Sequence[Outcome]) -> ReportSection:
    rows = [("this loop", *_shares(outcomes, lambda o: o.hit and (o.kind != "unknown")))]
    tried = {method for o in outcomes for method in o.baselines}  # a regression on shapes has nothing in markers
    rows += [(words, *_shares(outcomes, hits(method))) for method, words in BASELINE_METHODS if method in tried]
    header = ("method", f"single, R >= {VISIBLE:g}: right", "null: nothing named", "unknown: nothing named")
    words = (
        "The baselines name one effect or no effect, and cannot call an effect unknown. Servo and camera effects are "
        "not among the columns of the regression. Pairs are left out, because no baseline names two effects."
    )
    rows[0] = (*rows[0][:3], _percent(share(outcomes, "unknown", lambda o: o.hit)))
    return ReportSection(
        "Other methods on the same recordings", [words], [ReportTable("Share right", header, rows, numeric=(1, 2, 3))]
    )


def _shares(outcomes: Sequence[Outcome], right: Any) -> tuple[str, ...]:
    return (
        _percent(share(outcomes, "single", right, VISIBLE)),
        _percent(share(outcomes, "null", right)),
        _percent(share(outcomes, "unknown", right)),
    )


def _trial_section(outcomes: Sequence[Outcome], refused: Sequence[tuple[int, str]]) -> ReportSection:
    rows = []
    for o in outcomes:
        hidden = ", ".join(
            effect_name(name)
            + (f", {o.laws[name].replace('_', ' ')}" if name in o.laws else "")
            + (f" ({value:.1f})" if value == value else "")
            for name, value in zip(o.hidden, o.r, strict=True)
        )
        answer = ", ".join(map(effect_name, o.named)) or o.verdict.replace("_", " ")
        errors = tuple(number(value) for value in (o.before, o.after, o.floor))
        rows.append(
            (
                str(o.index),
                o.plant,
                o.seen,
                hidden or "nothing",
                answer,
                o.verdict.replace("_", " "),
                f"{o.confidence:.2f}",
                *errors,
            )
        )
    wrong = tuple(k for k, o in enumerate(outcomes) if not o.hit)
    header = (
        "trial",
        "plant",
        "seen",
        "hidden, by which law (R)",
        "named",
        "verdict",
        "confidence",
        "before [mm]",
        "after [mm]",
        "floor [mm]",
    )
    tables = [ReportTable("Every trial; marked: wrong", header, rows, numeric=(6, 7, 8, 9), warned=wrong)]
    if refused:
        tables.append(ReportTable("Not run", ("trial", "why"), [(str(k), why) for k, why in refused]))
    return ReportSection(
        "Trials", ["`--only N` with the same seed makes trial N again and keeps its recording."], tables
    )
