"""Fig. 9: mean thrust of a sine over amplitude and frequency for three arms, the reference and the reduced model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tentacle.io.csv_table import write_csv
from tentacle.runner import Runner
from tentacle.signals import Array
from tentacle.waveform import Ramped, Sine
from validation.model_pair import affine_twin, reference_twin
from validation.paper_arms import paper_arm
from validation.rank_correlation import rank_correlation

FIG9_LENGTHS = (0.105, 0.120, 0.140)
FIG9_SILICONE = "Dragon Skin 10"
FIG9_AMPLITUDES = (0.1, 0.25, 0.4, 0.55, 0.7, 0.85)  # rad
FIG9_FREQUENCIES = (0.3, 0.6, 0.9, 1.2, 1.5, 1.8, 2.1, 2.4)  # Hz
SETTLE_S, WINDOW_S = 3.0, 10.0  # the paper averages over 10 s
FIG9_ORDER = 2
VERSION = "1"


@dataclass(frozen=True)
class ThrustMaps:
    """Mean forward thrust [N] of three arms: reference and affine (length, amplitude, frequency).

    amplitudes [rad], frequencies [Hz].
    """

    amplitudes: tuple[float, ...]
    frequencies: tuple[float, ...]
    reference: Array
    affine: Array

    @property
    def ranks(self) -> list[float]:
        """Spearman's rank correlation of the two maps, one for each arm."""
        return [rank_correlation(r.ravel(), a.ravel()) for r, a in zip(self.reference, self.affine, strict=True)]

    @property
    def errors(self) -> list[float]:
        """Mean |error| over mean |thrust|, one for each arm."""
        apart = np.abs(self.affine - self.reference).sum(axis=(1, 2))
        return (apart / np.abs(self.reference).sum(axis=(1, 2))).tolist()

    @property
    def lines(self) -> list[str]:
        """One sentence for each arm: agreement, and the sine with the most thrust in the reference."""
        lines = []
        for length, rank, error, r, a in zip(
            FIG9_LENGTHS, self.ranks, self.errors, self.reference, self.affine, strict=True
        ):
            i, j = np.unravel_index(np.argmax(r), r.shape)
            lines.append(
                f"{1e3 * length:.0f} mm: rank correlation {rank:.4f}, mean error {100 * error:.1f} %; most thrust"
                f" {1e3 * r[i, j]:.1f} mN (affine {1e3 * a[i, j]:.1f}) at {self.amplitudes[i]:g} rad,"
                f" {self.frequencies[j]:g} Hz"
            )
        return lines


def fig9_cell(task: Mapping[str, Any]) -> dict[str, float]:
    """Mean forward thrust [N] of one arm under one sine, by both models: -y, so that it swims base first."""
    frequency = task["frequency"]
    wave = Ramped(Sine(task["amplitude"], frequency), 1.0 / frequency)
    window = round(WINDOW_S * frequency) / frequency  # whole periods
    duration, fps = SETTLE_S + window, 32.0 * frequency
    model = paper_arm(task["length"], FIG9_SILICONE)
    reference = reference_twin(model, wave, duration, fps)
    affine = affine_twin(model, FIG9_ORDER, wave, duration, fps)
    return {"reference": -reference.mean_load(window), "affine": -affine.mean_load(window)}


def thrust_maps(runner: Runner, *, coarse: bool = False) -> ThrustMaps:
    """All cells of all arms; coarse: every other amplitude and frequency."""
    amplitudes, frequencies = (
        (FIG9_AMPLITUDES[::2], FIG9_FREQUENCIES[::2]) if coarse else (FIG9_AMPLITUDES, FIG9_FREQUENCIES)
    )
    tasks = [
        {"length": n, "amplitude": a, "frequency": f} for n in FIG9_LENGTHS for a in amplitudes for f in frequencies
    ]
    results = runner.run(fig9_cell, tasks, version=VERSION, words="Fig. 9")
    shape = (len(FIG9_LENGTHS), len(amplitudes), len(frequencies))
    reference, affine = (np.array([r[name] for r in results]).reshape(shape) for name in ("reference", "affine"))
    return ThrustMaps(amplitudes, frequencies, reference, affine)


def write_thrust_maps(maps: ThrustMaps, file: Path) -> None:
    """One row a cell."""
    grid = np.meshgrid(FIG9_LENGTHS, maps.amplitudes, maps.frequencies, indexing="ij")
    names = ("length_m", "amplitude_rad", "frequency_hz", "reference_thrust_n", "affine_thrust_n")
    columns = zip(names, (*grid, maps.reference, maps.affine), strict=True)
    write_csv(file, {name: np.asarray(values, dtype=float).ravel() for name, values in columns})
