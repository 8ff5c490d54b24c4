"""The paper's Table II: three arms, a slow and a fast sine, and the optimised gait, as speeds on the rail.

The paper does not state these; the values here are: the silicone, Dragon Skin 10; the rail's friction, PAPER_RAIL (the
21 cm arm at 3 rad/s then swims at the printed speed); the edge of its thrust map, pi/6 (its excitation, II-B) and 0.75
Hz (the 14 cm arm's sine then swims at the printed speed). The slow sine is the best of 0.25 to 0.5 Hz, the fast one of
0.5 to 0.75 Hz. The optimised gait has the same largest angle and the same largest fundamental frequency, so it gains by
its shape alone. The best sine and the best gait within all the limits of the servo are added; the paper does not have
them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from affine_model.swim.gaits import gait_of
from affine_model.swim.limits import HOBBY_SERVO, GaitLimits
from affine_model.swim.objectives import OBJECTIVES
from affine_model.swim.optimise import Swimming, for_objective, optimise_gait, promises
from affine_model.swim.search import SearchPlan
from affine_model.swim.silicones import assumed_model, paper_cone
from affine_model.swim.thrust_map import sine_gaits, sine_map
from affine_model.swim.trial import PAPER_RAIL, trial_of
from tentacle.gait import Gait
from tentacle.model import Model
from tentacle.servo_limits import ServoLimits

TABLE2_SILICONE = "dragon-skin-10"
SLOW_BAND, FAST_BAND = (0.25, 0.5), (0.5, 0.75)  # Hz
MAP_LIMITS = GaitLimits(
    ServoLimits(np.pi / 6.0, HOBBY_SERVO.speed, HOBBY_SERVO.acceleration), highest_frequency=FAST_BAND[1]
)
TABLE2_LIMITS = GaitLimits()
MOTIONS = ("slow sine", "fast sine", "optimised gait", "servo's best sine", "servo's best gait")


@dataclass(frozen=True)
class Printed:
    """Table II as printed: means and standard deviations of five swims [m/s], for slow sine, fast sine, optimised."""

    means: tuple[float, float, float]
    deviations: tuple[float, float, float]

    @property
    def ratio(self) -> float:
        """Optimised over the better sine."""
        return self.means[2] / max(self.means[:2])


PRINTED_SPEEDS = {
    0.14: Printed((0.0006, 0.0012, 0.0066), (0.0001, 0.0002, 0.0001)),
    0.21: Printed((0.0052, 0.0104, 0.0227), (0.0015, 0.0012, 0.0031)),
    0.25: Printed((0.0049, 0.0067, 0.0214), (0.0002, 0.0007, 0.0046)),
}


@dataclass(frozen=True)
class SwimRow:
    """One arm: its length [m], its model, the gaits named in MOTIONS, and their forward speeds (5,) [m/s].

    reference are the speeds of the independent simulation, None where it was not asked. within_map, within_servo: the
    searches behind the two gaits.
    """

    length: float
    model: Model
    gaits: tuple[Gait, ...]
    affine: tuple[float, ...]
    reference: tuple[float, ...] | None
    within_map: Swimming
    within_servo: Swimming


def ratios(speeds: tuple[float, ...]) -> tuple[float, float]:
    """Of speeds named by MOTIONS: gait over the better sine within the map (the paper's), and within the servo."""
    return speeds[2] / max(speeds[:2]), speeds[4] / speeds[3]


def table2(
    *,
    objective: str = "speed",
    evaluations: int = 5000,
    seed: int = 0,
    reference: Callable[[Model, Gait], float] | None = None,
    lengths: tuple[float, ...] = tuple(PRINTED_SPEEDS),
    device: str | None = None,
) -> list[SwimRow]:
    """Table II on the affine model; reference(model, gait) gives another simulation's speed [m/s] on PAPER_RAIL.

    device: where torch runs the searches' batches, as in Trial.
    """

    def best(model: Model, limits: GaitLimits) -> Swimming:
        trial = replace(trial_of(model, limits), device=device)
        return optimise_gait(trial, OBJECTIVES[objective], SearchPlan(evaluations=evaluations, seed=seed))

    return [_row(length, best, reference) for length in lengths]


def _row(
    length: float,
    best: Callable[[Model, GaitLimits], Swimming],
    reference: Callable[[Model, Gait], float] | None,
) -> SwimRow:
    model = assumed_model(paper_cone(length), TABLE2_SILICONE)
    within_map, within_servo = best(model, MAP_LIMITS), best(model, TABLE2_LIMITS)
    slow, fast = (_map_sine(model, band) for band in (SLOW_BAND, FAST_BAND))
    gaits = (slow, fast, within_map.gait, within_servo.sine, within_servo.gait)
    trial = trial_of(model)
    affine = tuple(one.speed for one in promises(trial, np.array([gait.alpha for gait in gaits]).T))
    measured = None if reference is None else tuple(reference(model, gait) for gait in gaits)
    return SwimRow(length, model, gaits, affine, measured, within_map, within_servo)


def _map_sine(model: Model, band: tuple[float, float]) -> Gait:
    """The best of the map's sines in a band of frequencies [Hz], by speed on the rail."""
    speed = OBJECTIVES["speed"]
    trial = for_objective(trial_of(model, MAP_LIMITS), speed, PAPER_RAIL)
    amplitudes, frequencies = MAP_LIMITS.servo.angle * np.array([0.5, 0.75, 1.0]), np.linspace(*band, 6)
    values = sine_map(trial, speed, amplitudes, frequencies).values
    row, column = np.unravel_index(int(np.nanargmax(values)), values.shape)
    alpha = sine_gaits(amplitudes[row : row + 1], frequencies[column : column + 1])
    return gait_of(alpha[:, 0], MAP_LIMITS.bandwidth)


TABLE2_HEADER = ("L", "source", *MOTIONS[:3], "gait / sine, map", *MOTIONS[3:], "gait / sine, servo")


def cells(rows: list[SwimRow]) -> list[tuple[str, ...]]:
    """The table as texts under HEADER, one line per arm and source: speeds in cm/s, and the two ratios."""
    lines: list[tuple[str, ...]] = []
    for row in rows:
        printed, name = PRINTED_SPEEDS[row.length], f"{100 * row.length:.0f} cm"
        shown = (f"{100 * mean:.2f}" for mean in printed.means)
        lines.append((name, "paper, in the tank", *shown, f"{printed.ratio:.1f}", "-", "-", "-"))
        for source, speeds in (("affine model", row.affine), ("MuJoCo reference", row.reference)):
            if speeds is not None:
                centimetres = [f"{100 * speed:.2f}" for speed in speeds]
                of_map, of_servo = (f"{ratio:.2f}" for ratio in ratios(speeds))
                lines.append((name, source, *centimetres[:3], of_map, *centimetres[3:], of_servo))
    return lines


REMARKS = (
    "First three speeds: within the paper's map (at most 30 deg and 0.75 Hz); a gait turns no further and "
    "repeats no faster than the sines there, it gains by its harmonics alone.",
    "Last two: all that a hobby servo can do. There the sine may be fast too, and little is left to gain.",
    "NOT INDEPENDENT of Table II: the paper states neither silicone, nor rail friction, nor its map's edge. The "
    "friction, 0.35 N s/m, was chosen so that the 21 cm arm at 3 rad/s swims as printed, the edge, 0.75 Hz, so that "
    "the 14 cm arm's fast sine does. The ratios were not fitted, but the edge decides them (--curves): of the 14 cm "
    "arm 11.7 at 0.6 Hz, 6.6 at 0.75, 2.7 at 1.0, 1.04 at 1.5; the friction hardly moves them.",
    "The tank adds what no model here has: stick-slip of the rail, waves, a carriage that drags in the water itself.",
)
