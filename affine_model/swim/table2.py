"""The paper's Table II: three arms, a slow and a fast sine, and the optimised gait, as speeds on the rail.

What the paper leaves open, and what is taken here: the silicone (Dragon Skin 10), the rail's friction (PAPER_RAIL), and
the sines of its thrust map. Fig. 9 is read as amplitudes up to pi/6 (the paper's excitation, II-B) and frequencies
about its 3 rad/s: the slow sine is the best of 0.25 to 0.5 Hz, the fast one the best of 0.5 to 0.75 Hz. The optimised
gait has the servo's limits instead of that map's edge. So the paper's ratio (over the better of its sines) mixes two
gains: leaving the map, and leaving the sine. The best sine within the same limits as the gait separates them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from affine_model.curvature import Array
from affine_model.swim.gaits import gait_of
from affine_model.swim.limits import GaitLimits
from affine_model.swim.objectives import OBJECTIVES
from affine_model.swim.optimise import Swimming, for_objective, optimise, promise
from affine_model.swim.silicones import assumed_model, paper_cone
from affine_model.swim.thrust_map import sine_gaits, sine_map
from affine_model.swim.trial import PAPER_RAIL, trial_of
from tentacle.model import Model
from tentacle.waveform import Gait

SILICONE = "dragon-skin-10"
MAP_AMPLITUDE = np.pi / 6.0
SLOW_BAND, FAST_BAND = (0.25, 0.5), (0.5, 0.75)  # Hz
MOTIONS = ("slow sine", "fast sine", "best sine within the servo's limits", "optimised gait")


@dataclass(frozen=True)
class Printed:
    """Table II as printed: means and standard deviations of five swims [m/s], for slow sine, fast sine, optimised."""

    means: tuple[float, float, float]
    deviations: tuple[float, float, float]

    @property
    def ratio(self) -> float:
        """Optimised over the better sine."""
        return self.means[2] / max(self.means[:2])


PRINTED = {
    0.14: Printed((0.0006, 0.0012, 0.0066), (0.0001, 0.0002, 0.0001)),
    0.21: Printed((0.0052, 0.0104, 0.0227), (0.0015, 0.0012, 0.0031)),
    0.25: Printed((0.0049, 0.0067, 0.0214), (0.0002, 0.0007, 0.0046)),
}


@dataclass(frozen=True)
class Row:
    """One arm: its length [m], its model, the gaits named in MOTIONS, and their forward speeds [m/s].

    reference (4,) are the speeds of the independent simulation, None where it was not asked. found: the whole search.
    """

    length: float
    model: Model
    gaits: tuple[Gait, Gait, Gait, Gait]
    affine: tuple[float, ...]
    reference: tuple[float, ...] | None
    found: Swimming

    @staticmethod
    def ratios(speeds: tuple[float, ...]) -> tuple[float, float]:
        """The optimised gait over the better of the map's sines (the paper), and over the best sine that the
        servo can do.
        """
        return speeds[3] / max(speeds[:2]), speeds[3] / speeds[2]


def table2(
    *,
    objective: str = "speed",
    evaluations: int = 5000,
    seed: int = 0,
    limits: GaitLimits | None = None,
    reference: Callable[[Model, Gait], float] | None = None,
    lengths: tuple[float, ...] = tuple(PRINTED),
) -> list[Row]:
    """Compute Table II on the affine model; reference(model, gait) gives an independent simulation's speed [m/s] on
    PAPER_RAIL.
    """
    limits = limits or GaitLimits()
    return [_row(length, objective, evaluations, seed, limits, reference) for length in lengths]


def _row(
    length: float,
    objective: str,
    evaluations: int,
    seed: int,
    limits: GaitLimits,
    reference: Callable[[Model, Gait], float] | None,
) -> Row:
    model = assumed_model(paper_cone(length), SILICONE)
    trial = trial_of(model, limits)
    found = optimise(trial, OBJECTIVES[objective], evaluations=evaluations, seed=seed)
    slow, fast = (_map_sine(model, limits, band) for band in (SLOW_BAND, FAST_BAND))
    gaits = (slow, fast, found.sine, found.gait)
    affine = tuple(promise(trial, np.array(gait.alpha)).speed for gait in gaits)
    measured = None if reference is None else tuple(reference(model, gait) for gait in gaits)
    return Row(length, model, gaits, affine, measured, found)


def _map_sine(model: Model, limits: GaitLimits, band: tuple[float, float]) -> Gait:
    """The best of the map's sines in a band of frequencies, by speed on the rail."""
    speed = OBJECTIVES["speed"]
    trial = for_objective(trial_of(model, limits), speed, PAPER_RAIL)
    amplitudes, frequencies = MAP_AMPLITUDE * np.array([0.5, 0.75, 1.0]), np.linspace(*band, 6)
    values = sine_map(trial, speed, amplitudes, frequencies).values
    row, column = np.unravel_index(int(np.nanargmax(values)), values.shape)
    return _sine(float(amplitudes[row]), float(frequencies[column]), limits.bandwidth)


def _sine(amplitude: float, frequency: float, bandwidth: float) -> Gait:
    return gait_of(sine_gaits(np.array([amplitude]), np.array([frequency]))[:, 0], bandwidth)


def cells(rows: list[Row]) -> list[list[str]]:
    """The table as texts, one line per arm and source (paper, affine, reference): four speeds in cm/s and two ratios."""
    lines: list[list[str]] = []
    for row in rows:
        printed = PRINTED[row.length]
        shown = [f"{100 * value:.2f}" for value in printed.means]
        name = f"{100 * row.length:.0f} cm"
        lines.append([name, "paper (tank)", shown[0], shown[1], "-", shown[2], f"{printed.ratio:.1f}", "-"])
        sources = [("affine model", row.affine), ("MuJoCo reference", row.reference)]
        for source, speeds in sources:
            if speeds is not None:
                over_map, over_sine = Row.ratios(speeds)
                centimetres = [f"{100 * value:.2f}" for value in speeds]
                lines.append([name, source, *centimetres, f"{over_map:.1f}", f"{over_sine:.2f}"])
    return lines


HEADER = ["L", "source", *(f"{motion} [cm/s]" for motion in MOTIONS), "over the map's sines", "over the best sine"]


def speeds_of(row: Row) -> Array:
    """The speeds that count (4,) [m/s]: the reference's where it was asked, else the affine model's."""
    return np.array(row.affine if row.reference is None else row.reference)
