"""Blind trials: many recordings, each with effects drawn at random, and the answers kept apart."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from mujoco_ref.influence import KNOWN, UNCATALOGUED
from mujoco_ref.undeclared.make import USUAL_NOISE, Noise, Strength, make
from mujoco_ref.undeclared.strength import SCALED
from tentacle.model import Model
from tentacle.recording import Recording
from tentacle.waveform import Waveform


@dataclass(frozen=True)
class Trial:
    """One blind recording, without a hint of its effects in name or declaration, and its sealed truth."""

    recording: Recording
    truth: dict[str, Any]


def draw_effects(random: np.random.Generator, uncatalogued: float, nothing: float, most: int) -> dict[str, Strength]:
    """Effects for one trial: none with probability `nothing`, one that no catalogue has with `uncatalogued`, else 1 to
    `most`."""
    catalogued = [name for name in KNOWN if name in SCALED and SCALED[name] and name not in UNCATALOGUED]
    kind = random.uniform()
    if kind < nothing:
        return {}
    if kind < nothing + uncatalogued:
        return {str(random.choice(UNCATALOGUED)): "visible"}
    count = int(random.integers(1, most + 1))
    names = random.choice(catalogued, size=count, replace=False)
    return {str(name): str(random.choice(["visible", "faint"])) for name in names}


def trials(
    model: Model,
    waveform: Waveform,
    count: int,
    seed: int,
    duration: float,
    fps: float,
    noise: Noise = USUAL_NOISE,
    *,
    uncatalogued: float = 0.15,
    nothing: float = 0.15,
    most: int = 1,
) -> Iterator[Trial]:
    """`count` trials, one at a time; trial k depends on seed and k alone, so any part can be made again."""
    for k in range(count):
        random = np.random.default_rng([seed, k])
        effects = draw_effects(random, uncatalogued, nothing, most)
        number = int(random.integers(2**31))
        recording, truth = make(effects, model, waveform, number, duration, fps, noise, name=f"trial_{k:03d}")
        yield Trial(recording, {"trial": k, **truth})
