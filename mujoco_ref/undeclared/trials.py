"""Blind trials: many recordings, each with effects drawn at random, and the answers in a separate file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from mujoco_ref.influence import KNOWN, UNCATALOGUED
from mujoco_ref.undeclared.make import USUAL_NOISE, Noise, Scenario, Strength, make_recording
from mujoco_ref.undeclared.strength import SCALED_TOGETHER
from tentacle.model import Model
from tentacle.recording import Recording
from tentacle.waveform import Waveform


@dataclass(frozen=True)
class SimulatedTrial:
    """One blind recording, without a hint of its effects in name or declaration, and its sealed truth."""

    recording: Recording
    truth: dict[str, Any]


def draw_effects(random: np.random.Generator, uncatalogued: float, nothing: float, most: int) -> dict[str, Strength]:
    """Effects for one trial: none with probability `nothing`, one outside the catalogue with `uncatalogued`, else 1 to
    `most`.
    """
    catalogued = [
        name for name in KNOWN if name in SCALED_TOGETHER and SCALED_TOGETHER[name] and name not in UNCATALOGUED
    ]
    kind = random.uniform()
    if kind < nothing:
        return {}
    if kind < nothing + uncatalogued:
        return {str(random.choice(UNCATALOGUED)): "visible"}
    count = int(random.integers(1, most + 1))
    names = random.choice(catalogued, size=count, replace=False)
    return {str(name): str(random.choice(["visible", "faint"])) for name in names}


@dataclass(frozen=True)
class SealedPlan:
    """The settings common to all trials, and the shares of trials with nothing hidden and with an effect outside the
    catalogue.

    most: effects in one trial at most. Trial k depends on the plan, the seed and k alone, so any can be made again.
    """

    model: Model
    waveform: Waveform
    seed: int
    duration: float
    fps: float
    noise: Noise = USUAL_NOISE
    uncatalogued: float = 0.15
    nothing: float = 0.15
    most: int = 1

    def trial(self, k: int, *, clean_midline: bool = False) -> SimulatedTrial:
        """The k-th trial."""
        random = np.random.default_rng([self.seed, k])
        effects = draw_effects(random, self.uncatalogued, self.nothing, self.most)
        recording, truth = make_recording(
            effects,
            Scenario(self.model, self.waveform, self.duration, self.fps),
            int(random.integers(2**31)),
            self.noise,
            name=trial_name(k),
            clean_midline=clean_midline,
        )
        return SimulatedTrial(recording, {"trial": k, **truth})


def trial_name(k: int) -> str:
    """The name of the k-th trial's recording, without a hint at its effects."""
    return f"trial_{k:03d}"
