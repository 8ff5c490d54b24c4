"""Recordings of one arm, whose material and water follow laws that nobody declares.

Every lab's arm has such laws, in each of its recordings. The baseline is filmed on another day: the base moves
otherwise, and stiffness and damping differ by SPREAD. What is hidden acts in the later recording alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from validation.plants.draw import Filming, Trial, drawn
from validation.plants.filmed import Plant, sized

OWN = ("amplitude_damping", "cubic_stiffness", "dry_friction", "linear_drag", "skin_drag", "viscoelasticity")
SPREAD = 0.01  # relative standard deviation between two days, of stiffness and damping


def with_own_laws(trial: Trial, plant: Plant, effects: Sequence[str], size: tuple[float, float]) -> Trial:
    """The trial's arm with these laws of OWN, by a published law each. size: how far each moves the midline, rms, in
    standard deviations of its noise (drawn between).
    """
    like = drawn(trial.seed + 1, effects, {}, _filming(trial), size)
    bare = replace(trial, hidden=like.hidden, size=like.size)
    return replace(trial, own=sized(bare, plant))


def repeated(trial: Trial) -> Trial:
    """The same arm on another day, with nothing hidden."""
    other = drawn(trial.seed + 2, (), {}, _filming(trial), (1.0, 1.0))
    random = np.random.default_rng([trial.seed, 24])
    arm = {**trial.arm, **{name: trial.arm[name] * (1.0 + SPREAD * random.standard_normal()) for name in ("E", "eta")}}
    return replace(trial, seed=other.seed, arm=arm, motion=other.motion, chirps=other.chirps, hidden=(), size=())


def _filming(trial: Trial) -> Filming:
    return Filming(trial.seconds, trial.fps, trial.sigma)
