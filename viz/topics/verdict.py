"""The verdict as a page of text inside the session."""

from __future__ import annotations

import rerun as rr

from tentacle.diagnosis import Diagnosis
from tentacle.rounding import number
from viz.words import effect_name, error_rows, in_ranking, in_words, ranked_columns, verdict_title

CANDIDATE_HEADER = ("effect", "score alone [nat]", "error alone [mm]", "probability of all sets with it")


def text_table(header: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    """A Markdown table."""
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines)


def verdict_markdown(diagnosis: Diagnosis) -> str:
    """Headline, errors, parameters of what was added, ranking, and what remains."""
    if diagnosis.cannot_tell:
        return f"# {verdict_title(diagnosis)}\n\n{diagnosis.headline}\n"
    judged = "held-out data" if diagnosis.held_out else "the data that were fitted"
    errors = error_rows(diagnosis.before, diagnosis.after, diagnosis.floor)
    parts = [
        f"# {verdict_title(diagnosis)}",
        in_words(diagnosis.headline, diagnosis),
        f"Confidence {diagnosis.confidence:.0%}. Errors are rms on {judged}.",
        text_table(("error", "unit", "before", "after", "floor"), [tuple(row) for row in errors]),
    ]
    added = [
        (effect_name(effect), name, number(e.value), e.interval_words, e.unit)
        for effect, values in diagnosis.parameters.items()
        for name, e in values.items()
    ]
    if added:
        parts += ["## Added", text_table(("effect", "parameter", "value", "95 % interval", "unit"), added)]
    if diagnosis.ranking:
        ranked = [
            (effect_name(r.effect), number(r.score), number(r.held_out_midline_mm), f"{r.probability:.2f}")
            for r in in_ranking(diagnosis)[:8]
        ]
        columns = ranked_columns(diagnosis)
        rows = [row[:columns] for row in ranked]
        parts += ["## Candidates", text_table(CANDIDATE_HEADER[:columns], rows)]
    if diagnosis.sentences:
        parts += ["## What remains", "\n".join(f"- {in_words(line, diagnosis)}" for line in diagnosis.sentences)]
    return "\n\n".join(parts) + "\n"


def log_verdict(session: rr.RecordingStream, diagnosis: Diagnosis) -> None:
    """The verdict's page, on every time line."""
    text = rr.TextDocument(verdict_markdown(diagnosis), media_type=rr.MediaType.MARKDOWN)
    session.log("verdict", text, static=True)
