"""The words about laws: what a law is called by its sign and place, and what the search found."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from discovery.laws.inside import AT_PLACE
from discovery.laws.search import FittedLaw
from tentacle.law.written_law import WrittenLaw
from tentacle.proposed_law import ProposedLaw

ALIKE = 3.0  # nats: laws that are no farther apart do equally well
CONTRARY = {
    "towards": "away from",
    "stiffening": "softening",
    "more stiffness": "less stiffness",
}  # where the strength a is negative
LAW_KINDS = {
    "the speed": ("drag_", "skin_", "one_way", "tip_drag"), "the speed near a place": ("patch_",),
    "the place of the tip": ("attraction", "tether", "tip_spring", "stop_"),
    "the place of one section": ("inside_attraction", "inside_tether", "inside_spring", "inside_stop_"),
    "the speed of one section": ("inside_drag",),
    "the place of every section": ("jet", "line_spring"), "time": ("vortex", "beat_x", "tip_beat", "inside_beat"),
    "nothing (a steady force)": ("tip_push", "inside_push"),
    "the curvature": ("bending", "one_sided"), "the curvature before": ("late",),
}  # fmt: skip


def title_of(law: WrittenLaw, values: Mapping[str, float]) -> str:
    """The law's title with these values: the way of its force by the sign of a, and the section where it acts."""
    title = law.title
    if values.get("a", 0.0) < 0.0:
        for said, contrary in CONTRARY.items():
            title = title.replace(said, contrary)
    return title.replace(AT_PLACE, f"s = {values['at_s']:.2f}") if "at_s" in values else title


def kinds_of(found: Sequence[FittedLaw]) -> tuple[tuple[str, float], ...]:
    """Of each kind of law, the share of the missing force's answer that its best law leaves."""
    rows = {kind: [one.unexplained for one in found if one.form.law.name.startswith(starts)]
            for kind, starts in LAW_KINDS.items()}  # fmt: skip
    return tuple((kind, min(left)) for kind, left in rows.items() if left)


def proposals_words(laws: tuple[ProposedLaw, ...], kinds: tuple[tuple[str, float], ...]) -> tuple[str, ...]:
    """What the search found, each with its evidence."""
    if not laws:
        return ("No law of the grammar predicts the held-out frames: none is proposed.",)
    best = laws[0]
    most = best.unexplained < 0.5
    words = [
        f"{'Proposed law' if most else 'No law explains most of the structured error. The best one'}: {best.words}. "
        f"It leaves {100.0 * best.unexplained:.0f} % of the structured error; "
        f"the error on held-out frames is {best.held_out_midline_mm:.2f} mm."
    ]
    if alike := [law.words for law in laws[1:] if best.evidence - law.evidence < ALIKE]:
        words.append(f"These do as well, within {ALIKE:.0f} nats: {'; '.join(alike)}.")
    elif len(laws) > 1:
        words.append(f"The next law, {laws[1].words}, is {best.evidence - laws[1].evidence:.0f} nats behind.")
    if region := best.region_words:
        words.append(region)
    shares = ", ".join(f"{kind} {100.0 * left:.0f} %" for kind, left in sorted(kinds, key=lambda row: row[1]))
    words.append(f"Share of the missing force's effect that the best law of each kind leaves: {shares}.")
    return tuple(words)
