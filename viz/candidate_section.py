"""The candidates of a diagnosis in its report: how they rank, and which of them resemble one another."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from tentacle.diagnosis import Diagnosis
from tentacle.rounding import number
from tentacle.signals import Array
from viz.figures.twins import twins_figure
from viz.report import Picture, ReportSection, ReportTable
from viz.words import effect_name, in_ranking, listed, probability_words, ranked_columns

PRICE = 7.6  # nat: gain of one parameter that is larger than by chance
TWIN_COSINE = 0.85  # pairs above this are named in words
MOST_TWINS = 8  # of them in a sentence
RANKED_WORDS = (
    "A score is the log-likelihood that an effect gains when it alone is added to the declared model. The probability "
    "is that of all sets that hold the effect. So an effect that helps only beside another one can have a score below "
    "zero and a high probability.",
    "The judged error is also of the effect alone. It is run at the values that were fitted beside unknown forces, but "
    "without these forces. The errors before and after are of values that were fitted without them. So the error of a "
    "probable effect can be larger here than that of the declared model there.",
)
UNKNOWN_WORDS = (
    "A score is the log-likelihood that an effect gains when it alone is added to the declared model.",
    "None of them has a probability: what acts is something else, and they only resemble it.",
)


def twin_words(names: Sequence[str], cosines: Array, sets: Sequence[Collection[str]] = ()) -> str:
    """Sentences about the pairs of effects that are alike in these recordings: those that the likely answers (sets of
    effects) leave open, and those that they tell apart. Without sets all are open.
    """
    pairs = sorted(
        (
            (abs(float(cosines[i, j])), names[i], names[j])
            for i in range(len(names))
            for j in range(i)
            if abs(cosines[i, j]) >= TWIN_COSINE
        ),
        reverse=True,
    )
    if not pairs:
        return f"No pair of candidates has |cos| above {TWIN_COSINE:g}: this excitation separates them."
    left, apart = [], []
    for cosine, one, other in pairs:
        counts = {name: sum(name in effects for effects in sets) for name in (one, other)}
        first, second = sorted((one, other), key=lambda name: -counts[name])
        if sets and counts[first] == len(sets) and not counts[second]:
            apart.append(f"{effect_name(first)} / {effect_name(second)} ({cosine:.3f})")
        elif not sets or any((one in effects) != (other in effects) for effects in sets):
            left.append(f"{effect_name(one)} / {effect_name(other)} ({cosine:.3f})")
    words = []
    if left:
        told = "; ".join(left[:MOST_TWINS])
        words.append(
            f"Nearly twins under this excitation: {told}. Only much more data, or another motion, separates them."
        )
    if apart:
        told = "; ".join(apart[:MOST_TWINS])
        words.append(f"Alike, yet told apart here: {told}. Every likely answer holds the first, and none the second.")
    if len(left) + len(apart) < len(pairs):
        which = "other pairs" if words else "pairs"
        words.append(
            f"Of the {which} with |cos| above {TWIN_COSINE:g} each likely answer holds both effects or neither."
        )
    return " ".join(words)


def candidate_section(diagnosis: Diagnosis) -> ReportSection:
    """The catalogue as ranked, and which candidates resemble one another."""
    ranking, columns = in_ranking(diagnosis), ranked_columns(diagnosis)
    worth = [r for r in ranking if r.score >= PRICE or r.effect in diagnosis.effects]
    rest = [effect_name(r.effect) for r in ranking if r not in worth]
    rows = [
        (effect_name(r.effect), number(r.score), number(r.held_out_midline_mm), probability_words(r.probability))
        for r in worth
    ]
    marked = tuple(k for k, ranked in enumerate(worth) if ranked.effect in diagnosis.effects)
    tables, pictures, paragraphs = [], [], []
    if rows:
        header = ("effect", "score alone [nat]", "judged error alone [mm]", "probability of all sets with it")
        most = max(max(r.score for r in worth), 1.0)
        bars = tuple(max(r.score, 0.0) / most for r in worth)
        caption = "Candidates. The bar behind the score is its share of the highest."
        shown = [row[:columns] for row in rows]
        numeric = tuple(range(1, columns))
        tables.append(ReportTable(caption, header[:columns], shown, numeric=numeric, marked=marked, bars=bars))
        paragraphs += UNKNOWN_WORDS if diagnosis.verdict == "unknown" else RANKED_WORDS
    if rest:
        paragraphs.append(f"Gain less than one parameter costs ({PRICE} nat): {listed(rest)}.")
    if len(diagnosis.twin_names) > 1:
        sets = [one.effects for one in diagnosis.sets]
        paragraphs.append(twin_words(diagnosis.twin_names, diagnosis.twin_cosines, sets))
        pictures.append(
            Picture(
                twins_figure(diagnosis.twin_names, diagnosis.twin_cosines),
                "Similarity of the candidates' effects on these recordings, after refitting the base parameters.",
            )
        )
    return ReportSection("Candidates", paragraphs, tables, pictures)
