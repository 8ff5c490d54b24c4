"""The report of a series of blind trials."""

from __future__ import annotations

from collections.abc import Sequence

from tentacle.cli.pages.blind_confidence import blind_error_section, reliability_section
from tentacle.cli.pages.blind_scores import baseline_section, confusion_section, percent, score_section
from tentacle.rounding import number
from validation.trials.outcome import Outcome
from validation.trials.reliability import cross_calibrated, fit_temperature, gap_by_chance, reliability
from validation.trials.scores import VISIBLE, scores
from viz.report import Origin, Report, ReportSection, ReportTable, render_report
from viz.words import effect_name


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
        f"R >= {VISIBLE:g} {percent(found.top1)} named first or in the group; false alarms on nulls "
        f"{percent(found.false_alarm)}; effects outside the catalogue called unknown "
        f"{percent(found.unknown_recall)}; both of a pair {percent(found.pairs)}."
    )
    crossed = reliability(cross_calibrated(outcomes))
    sections = [
        *before,
        score_section(found),
        confusion_section(outcomes),
        reliability_section(reliability(outcomes), crossed, (gap_by_chance(outcomes), fit_temperature(outcomes))),
        blind_error_section(outcomes),
        baseline_section(outcomes),
        _trial_section(outcomes, refused),
    ]
    merits = [
        ("top-1", percent(found.top1)),
        ("false alarms", percent(found.false_alarm)),
        ("unknown recall", percent(found.unknown_recall)),
        ("after / floor", number(found.after_over_floor)),
    ]
    return render_report(Report("blind-trial", "Blind trials", headline, sections, origin, merits))


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
