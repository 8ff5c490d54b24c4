"""Design of the blind trials in a plant: the plant, its hidden effects, duration and noise of the recording."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np

from tentacle.errors import InputError
from validation.plants import PLANTS, Filming, Trial, drawn
from validation.plants.laws import LAWS, OUTSIDE
from validation.plants.repeats import OWN
from validation.trials.rounds import TRIAL_KINDS, TrialKind, dealt, log_uniform

DRAWN_PLANTS = ("stranger", "chain")  # plants of a series by default: those that need no further package
DURATION_RANGE = (12.0, 39.0)
NOISE_RANGE = (5e-5, 2e-4)  # m, of each coordinate of a midline point
VIDEO_NOISE = 2e-5  # m: a midline's noise with as little information as the tracker's (some micrometres to 30)
FRAME_RATE = 60.0
# How far the midline moves, in sigmas of its noise: of an effect of the catalogue, faint ones too; of one outside it.
MOVES, MOVES_VISIBLY = (1.0, 15.0), (6.0, 15.0)


@dataclass(frozen=True)
class PlantDesign:
    """One trial as plain data: all that its recording depends on.

    index; seed of the plant's arm, motion, laws and noise; kind; effects hidden; plant; seen: as points of the midline
    or as a video; seconds; sigma [m]: noise of each coordinate of a midline point. own: undeclared laws of the arm,
    which act in a baseline too; without any there is no baseline.
    """

    index: int
    seed: int
    kind: TrialKind
    effects: tuple[str, ...]
    plant: str
    seen: Literal["midline", "video"]
    seconds: float
    sigma: float
    own: tuple[str, ...] = ()

    def table(self) -> dict[str, Any]:
        """The design as JSON holds it."""
        return {**asdict(self), "effects": list(self.effects), "own": list(self.own)}

    @staticmethod
    def of(table: Mapping[str, Any]) -> PlantDesign:
        """The design of a table."""
        return PlantDesign(**{**table, "effects": tuple(table["effects"]), "own": tuple(table["own"])})

    def trial(self) -> Trial:
        """The plant's arm, motion, hidden effects, and the laws by which they act."""
        moves = MOVES_VISIBLY if self.kind == "unknown" else MOVES
        return drawn(self.seed, self.effects, {}, Filming(self.seconds, FRAME_RATE, self.sigma), moves)


def plant_designs(
    count: int,
    seed: int,
    *,
    plants: Sequence[str] = DRAWN_PLANTS,
    kinds: Sequence[str] = TRIAL_KINDS,
    video_share: float = 0.25,
    repeats: bool = False,
) -> list[PlantDesign]:
    """The first `count` trials of a seed in these plants, drawn at random; a longer series begins with a shorter one.
    repeats: every arm has one or two laws of its own, and a baseline.

    InputError where a plant or a kind is not known, or a share is none.
    """
    unknown = sorted(set(plants) - set(PLANTS))
    if unknown or not plants:
        raise InputError(f"{', '.join(unknown) or 'none'}", field="plant", expected=f"some of {', '.join(PLANTS)}")
    found = []
    for one in dealt(count, seed, tuple(LAWS), OUTSIDE, kinds=kinds, video_share=video_share):
        plant = str(one.random.choice(sorted(plants)))
        seconds = float(np.round(one.random.uniform(*DURATION_RANGE), 1))
        noise = log_uniform(one.random, *NOISE_RANGE)
        own_seed = int(one.random.integers(2**31))
        seen, sigma = ("video", VIDEO_NOISE) if one.video else ("midline", noise)
        own = _own_laws(one.random, one.effects) if repeats else ()
        found.append(PlantDesign(one.index, own_seed, one.kind, one.effects, plant, seen, seconds, sigma, own))
    return found


def _own_laws(random: np.random.Generator, hidden: Sequence[str]) -> tuple[str, ...]:
    """One or two laws that are not hidden in the recording alone."""
    names = sorted(set(OWN) - set(hidden))
    return tuple(str(name) for name in random.choice(names, size=int(random.integers(1, 3)), replace=False))
