"""When a law is sought beside a verdict, and which laws then stand beside it.

A combination of catalogued effects can do for one law that the catalogue lacks. So a law is also sought where the named
effects leave more than noise on held-out frames, and where more than one effect is named; it is shown only where it
follows those frames no worse than they do.
"""

from __future__ import annotations

from dataclasses import replace

from discovery.answer import without_proposal
from tentacle.diagnosis import Diagnosis
from tentacle.proposed_law import MissingForce

LEFT = 1.01  # of the floor: three in four right answers of the drawn blind trials leave less on held-out frames


def seeks_laws(answer: Diagnosis) -> bool:
    """Whether a law could say more than the verdict does."""
    if answer.verdict == "unknown":
        return True
    named = answer.missing_effects
    if not named:
        return False
    after, floor = answer.after.midline_mm, answer.floor.midline_mm
    leaves = after is not None and floor is not None and after > LEFT * floor
    return leaves or (answer.verdict == "effect" and len(named) > 1)


def with_laws(answer: Diagnosis, missing: MissingForce) -> Diagnosis:
    """The answer with the missing force and its laws; beside named effects only with laws that do as well.

    After an unknown the next experiment is that on the laws, or none. Beside named effects it is that on the effects.
    """
    if answer.verdict == "unknown":
        asked = missing.experiment
        words = (*without_proposal(answer.words), *(() if asked is None else (asked.words,)))
        motion, nats = (None, None) if asked is None or asked.motion is None else (asked.motion, asked.nats)
        return replace(answer, missing=missing, words=words, next_experiment=motion, next_nats=nats)
    after = answer.after.midline_mm
    rivals = tuple(
        law for law in missing.laws
        if law.held_out_midline_mm is not None and after is not None and law.held_out_midline_mm <= after
    )  # fmt: skip
    if not rivals:
        return answer
    best = rivals[0]
    word = (
        f"A law follows the held-out frames at least as well as the named effects ({best.held_out_midline_mm:.2f} mm; "
        f"they {after:.2f} mm): {best.words}. Compare it with them: --effects laws/{best.law.name}.toml."
    )
    shown = replace(missing, laws=rivals, experiment=None)
    return replace(answer, missing=shown, words=(*answer.words, word))
