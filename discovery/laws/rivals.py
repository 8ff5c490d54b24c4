"""When a law is sought beside a verdict, and which laws then stand beside it.

A combination of catalogued effects can do for one law that the catalogue lacks. So a law is also sought where the named
effects leave more than noise on held-out frames, and where more than one effect is named; it is shown only where it
follows those frames no worse than they do.

Where one effect is named whose catalogued law is one of a family (a drag of another power, a stiffening of another
power, a drag to one side only), the laws of that family alone are sought: they say what the recordings tell of its
form.

Where nothing is named, a law may hide in what the declared model's own parameters do not take up. It is sought where
the model leaves clearly more than noise, unless a baseline shows that the declared model leaves as much by itself. It
is shown only where it takes away most of what the model leaves beyond noise.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from discovery.answer import far_from_floor, without_proposal
from discovery.laws.operating_point import EVERY_FORM
from tentacle.diagnosis import Diagnosis
from tentacle.proposed_law import MissingForce

LEFT = 1.01  # of the floor: three in four right answers of the drawn blind trials leave less on held-out frames
FAMILY = {
    "linear_drag": ("drag_", "tip_drag"),
    "reynolds_drag": ("drag_",),
    "skin_drag": ("skin_",),
    "current": ("one_way_",),
    "wall": ("patch_",),
    "cubic_stiffness": ("bending", "one_sided"),
    "amplitude_damping": ("bending_loss",),
}  # how the names of the grammar's forms begin that an effect's law is one of
MATTERS = 0.5  # of the square of the error beyond noise: a law that is shown where nothing is named leaves less


def sought_forms(answer: Diagnosis, own_error: bool = False) -> tuple[str, ...]:
    """How the names of the forms begin that could say more than the verdict does; empty where none could.

    own_error: whether the baseline's recordings need unknown forces as large beside the declared model.
    """
    if answer.verdict == "unknown":
        return EVERY_FORM
    named = answer.missing_effects
    after, floor = answer.after.midline_mm, answer.floor.midline_mm
    if not named:
        return EVERY_FORM if far_from_floor(after, floor) and not own_error else ()
    if far_from_floor(after, floor, LEFT) or (answer.verdict == "effect" and len(named) > 1):
        return EVERY_FORM
    return tuple(dict.fromkeys(name for effect in named for name in FAMILY.get(effect, ())))


def with_laws(answer: Diagnosis, missing: MissingForce) -> Diagnosis:
    """The answer with the missing force and its laws; beside named effects only with laws that do as well, and where
    nothing is named only with laws that do much better.

    After an unknown the next experiment is that on the laws, or none. Beside another verdict it stays as it is.
    """
    if answer.verdict == "unknown":
        asked = missing.experiment
        words = (*without_proposal(answer.words), *(() if asked is None else (asked.words,)))
        motion, nats = (None, None) if asked is None or asked.motion is None else (asked.motion, asked.nats)
        return replace(answer, missing=missing, words=words, next_experiment=motion, next_nats=nats)
    after, most = answer.after.midline_mm, _most_left(answer)
    rivals = tuple(
        law for law in missing.laws if law.held_out_midline_mm is not None and law.held_out_midline_mm <= most
    )
    if not rivals:
        return answer
    best = rivals[0]
    file = f"--effects laws/{best.law.name}.toml"
    word = (
        f"A law follows the held-out frames at least as well as the named effects ({best.held_out_midline_mm:.2f} mm; "
        f"they {after:.2f} mm): {best.words}. Compare it with them: {file}."
        if answer.missing_effects
        else f"No effect is named, but a law follows the held-out frames better ({best.held_out_midline_mm:.2f} mm; "
        f"without it {after:.2f} mm): {best.words}. Test it: {file}."
    )
    shown = replace(missing, laws=rivals, experiment=None)
    return replace(answer, missing=shown, words=(*answer.words, word))


def _most_left(answer: Diagnosis) -> float:
    """The largest error [mm] on held-out frames of a law that is shown beside the answer; below 0 where none is."""
    after, floor = answer.after.midline_mm, answer.floor.midline_mm
    if after is not None and answer.missing_effects:
        return after
    if after is None or floor is None:
        return -1.0
    return float(np.sqrt(floor**2 + MATTERS * max(after**2 - floor**2, 0.0)))
