"""Plants for trials: simulators of an arm in a tank, on which the loop is tested. Each hides effects by its own laws.

make(plant, seed) gives a recording like one from a lab, and the truth about it. The same plant and seed give the
same recording. Plants: "stranger", a rod of point masses that shares no line with the project's two models; "chain",
rigid links in MuJoCo, whose links, hinges and steps differ from those of the chain that the loop uses; "elastica",
PyElastica's rod, which also shears (where PyElastica is installed).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from tentacle.errors import InputError
from tentacle.recording import Recording
from validation.plants import chain, elastica, stranger
from validation.plants.draw import USUAL_FILMING, Filming, Trial, drawn
from validation.plants.filmed import Plant, Shown, recorded, shown, truth_of

__all__ = ["PLANTS", "Filming", "Plant", "Shown", "Trial", "drawn", "make", "recorded", "shown", "truth_of"]

PLANTS: dict[str, Callable[[Trial], Plant]] = {
    "stranger": stranger.plant,
    "chain": chain.plant,
    "elastica": elastica.plant,
}


def make(
    plant: str,
    seed: int,
    *,
    effects: Sequence[str] | None = None,
    laws: dict[str, str] | None = None,
    filming: Filming = USUAL_FILMING,
    size: tuple[float, float] = (6.0, 15.0),
) -> tuple[Recording, dict[str, Any]]:
    """A recording of that plant, and its truth (plain data for a JSON file).

    effects: what is hidden (names of validation.plants.laws.LAWS and OUTSIDE, none: ()); drawn where None. laws: of an
    effect the law that acts, drawn where not given.
    size: how far the hidden effects move the midline, rms, in standard deviations of its noise (drawn between).
    The truth holds: plant, seed, verdict ("nothing_missing", "effect" or "unknown"), effects (name -> numbers), laws
    (name -> law), arm, motion, moved_mm, noise_mm. InputError for a plant, effect or law that is not known.
    """
    if plant not in PLANTS:
        raise InputError(f"{plant!r} is not known", field="plant", expected=f"one of {', '.join(PLANTS)}")
    trial = drawn(seed, effects, laws or {}, filming, size)
    made = PLANTS[plant](trial)
    run = shown(trial, made)
    return recorded(trial, run), {"plant": plant, **truth_of(trial, made, run)}
