"""What is said of the missing force and of the laws that were searched for it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from discovery.answer import nats_words
from discovery.laws.over import over_words, share_words
from discovery.laws.search import FittedLaw
from discovery.next_experiment import DURATION, Proposal
from tentacle.proposed_law import ForceOver, LawExperiment, ProposedLaw

Kinds = Mapping[str, Sequence[FittedLaw]]

ALIKE = 3.0  # nats: laws that are no farther apart do equally well
ONE_PLACE = 0.9  # share of the missing force that one normal force explains, from which it is said to act at its place


def missing_words(
    laws: tuple[ProposedLaw, ...], kinds: Kinds, refused: Mapping[str, str], over: tuple[ForceOver, ...]
) -> tuple[str, ...]:
    """All sentences about the missing force. laws: best first; kinds: the laws of each kind in the search, the one that
    leaves least first; refused: the name of a law that was fitted and is not proposed, and why not.
    """
    if laws:
        words = best_words(laws, over[0])
    elif refused:
        words = [no_law_words(over[0], "none of those that were fitted can be proposed")]
    else:
        least = min(found[0].unexplained for found in kinds.values())
        words = [no_law_words(over[0], f"the best leaves {share_words(least)}")]
    return (*words, *kind_words(laws, kinds, refused), over_words(over))


def no_law_words(over: ForceOver, why: str) -> str:
    """The sentence that stands first where no law fits."""
    place = "the tip" if over.s == 1.0 else over.place
    where = f"A force at {place} is missing, across the arm" if over.explained >= ONE_PLACE else "A force is missing"
    return f"{where}; no law of the grammar fits it ({why})."


def best_words(laws: tuple[ProposedLaw, ...], over: ForceOver) -> list[str]:
    """Sentences about the best law: its expression, its error, its reach and its place. Then the laws next to it."""
    best = laws[0]
    left = share_words(best.unexplained)
    error = best.held_out_midline_mm
    leaves = f"It leaves {left} of the error that is not noise"
    words = [f"Proposed law: {best.words}."]
    if not best.fits:
        words = [no_law_words(over, f"the best leaves {left}"), f"The best law is {best.words}."]
    words.append(f"{leaves}." if error is None else f"{leaves}; the error on held-out frames is {error:.2f} mm.")
    # The interval of a place holds if the law is true: beside one that does not fit it would say nothing.
    words += [sentence for sentence in (best.reach_words, best.region_words if best.fits else "") if sentence]
    if alike := [law.words for law in laws[1:] if best.evidence - law.evidence < ALIKE]:
        words.append(f"These do as well, within {ALIKE:.0f} nats: {'; '.join(alike)}.")
    elif len(laws) > 1:
        words.append(f"The next law, {laws[1].words}, is {nats_words(best.evidence - laws[1].evidence)} behind.")
    return words


def kind_words(laws: tuple[ProposedLaw, ...], kinds: Kinds, refused: Mapping[str, str]) -> list[str]:
    """What the best law of each kind leaves in the search, and why no law of a kind that leaves less there than each
    proposed law leaves is among them; without any proposed law, why the best of all is not.
    """
    best = sorted(kinds.items(), key=lambda row: row[1][0].unexplained)
    shares = ", ".join(f"{kind} {share_words(found[0].unexplained)}" for kind, found in best)
    words = [
        "The search compares laws about the smoothed motion, before any is fitted. There the best law of each kind "
        f"leaves this share of the missing force's effect: {shares}."
    ]
    proposed = {law.law.name for law in laws}
    ahead = [row for row in best if laws and row[1][0].unexplained < min(law.unexplained for law in laws)]
    for kind, found in ahead or best[: 0 if laws or not refused else 1]:
        names = [f"law_{one.form.law.name}" for one in found]
        if not proposed & set(names):
            why = refused.get(names[0], "other laws have more evidence in the search")
            words.append(f"The best law of {kind}, {found[0].form.law.title}, is not proposed: {why}.")
    return words


def experiment_of(proposal: Proposal | None, laws: tuple[ProposedLaw, ...]) -> LawExperiment | None:
    """The proposed experiment in words; None without a proposal. laws: those that it would separate."""
    if proposal is None:
        return None
    split = "; ".join(law.law.title for law in laws)
    gap = nats_words(proposal.nats)
    if proposal.asked is None:
        words = f"No base motion within the servo's limits separates these laws: {split}. The best gives {gap}."
        return LawExperiment(None, proposal.nats, words)
    motion = f"{DURATION:.0f} s of the base motion in next_experiment.toml"
    words = f"The next experiment, {motion}, would separate these laws by {gap}: {split}."
    return LawExperiment(proposal.asked, proposal.nats, words)
