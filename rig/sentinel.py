"""The drift sentinel: one motion, repeated, whose recordings are compared with each other and with no model.

The reference motion is a sine. A least-squares fit gives the mean, the swing and the lag of the tip's heading against
the base, and the swing of the thrust at twice the frequency: four numbers of each run. Tip and base are both taken from
the pictures, so that an error of the camera's clock, some milliseconds from run to run, cancels. The first runs repeat
the motion before anything can have changed. Their scatter is how well servo, camera, load cell and arm repeat it. A
later run y differs from their mean m by Student's t for a new observation (Fisher 1925),

    t = (y - m) / (s sqrt(1 + 1/n)),  n - 1 degrees of freedom,

with s the standard deviation of the n first runs. The level is shared among all comparisons of a campaign (Bonferroni).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import root_scalar
from scipy.stats import nct
from scipy.stats import t as student

from rig.reidentify import tracked
from rig.run_file import read_run
from tentacle.errors import InputError
from tentacle.recording import Recording
from tentacle.signals import Array
from tentacle.waveform import Sine

SETTLING = 3  # periods, until the arm repeats itself
FEWEST = 4  # periods that are compared
FEWEST_REPEATS = 3  # first runs
LEVEL = 0.01  # chance that a campaign without drift is told of one
NAMES = ("the tip's mean heading", "the tip's swing", "the tip's lag", "the thrust's swing")


@dataclass(frozen=True)
class Change:
    """What changed between the first reference runs and a later one: name, relative change (of the swing; of the lag
    in rad), and the half width of its interval.
    """

    name: str
    change: float
    half_width: float
    since: str

    @property
    def words(self) -> str:
        """One line for a person."""
        low, high = self.change - self.half_width, self.change + self.half_width
        told = _told(self.name, self.change)
        return f"{self.name} changed by {told} ({_told(self.name, low)} to {_told(self.name, high)}) since {self.since}"


def _told(name: str, value: float) -> str:
    """A change with its unit."""
    return f"{1e3 * value:.3g} mrad" if "lag" in name else f"{100.0 * value:.3g} %"


def sentinel_numbers(recording: Recording, motion: Sine) -> Array:
    """The four numbers (4,) of a run, means over its periods after settling: mean heading and swing of the tip [rad],
    its lag behind the base [rad], swing of the thrust [N]. InputError where fewer than FEWEST periods are seen.
    """
    shape, cell, motor = recording.shape, recording.load_cell, recording.motor
    if shape is None or cell is None or motor is None:
        raise InputError("lacks shapes, load cell or motor", field=recording.name, expected="a filmed run of the rig")
    t, coefficients = shape.t[shape.accepted], shape.coefficients[shape.accepted]
    bend = (coefficients[:, 1:] / np.arange(1, coefficients.shape[1])).sum(axis=1)
    seen_base = np.interp(t, motor.t, motor.angle) + coefficients[:, 0]
    tip, base = (_harmonics(t, y, motion.frequency) for y in (bend, seen_base))
    pull = _harmonics(cell.t, cell.thrust, 2 * motion.frequency, per=2)
    count = min(len(tip), len(pull))
    if count < FEWEST:
        raise InputError(f"shows {count} whole periods", field=recording.name, expected=f"at least {FEWEST}")
    (mean, sine, cosine), (_, *turn), (_, *pulled) = (y[:count].mean(axis=0) for y in (tip, base, pull))
    lag = np.angle(complex(*turn) / complex(sine, cosine))
    return np.array([mean, np.hypot(sine, cosine), lag, np.hypot(*pulled)])


def _harmonics(t: Array, y: Array, frequency: float, per: int = 1) -> Array:
    """Mean, sine and cosine (P, 3) of y in each stretch of `per` periods of `frequency` [Hz] after settling."""
    length, found = per / frequency, []
    for begin in np.arange(SETTLING, np.floor(t[-1] / length)) * length if len(t) else ():
        inside = (t >= begin) & (t < begin + length)
        if inside.sum() < 8:
            continue
        phase = 2 * np.pi * frequency * t[inside]
        columns = np.column_stack([np.ones_like(phase), np.sin(phase), np.cos(phase)])
        found.append(np.linalg.lstsq(columns, y[inside])[0])
    return np.array(found).reshape(-1, 3)


@dataclass(frozen=True)
class ReferenceRuns:
    """The first reference runs' numbers (N, 4), and how many later runs the campaign compares with them at most."""

    numbers: Array
    comparisons: int

    @property
    def scale(self) -> Array:
        """What a change is relative to (4,): the swing of the tip, 1 rad of lag, the swing of the thrust."""
        mean = self.numbers.mean(axis=0)
        return np.array([mean[1], mean[1], 1.0, mean[3]])

    @property
    def error(self) -> Array:
        """Standard deviation (4,) of a later run's relative difference from the mean of these, without drift."""
        count = len(self.numbers)
        return self.numbers.std(axis=0, ddof=1) * np.sqrt(1 + 1 / count) / self.scale

    @property
    def quantile(self) -> float:
        """Student's t beyond which a difference is a change."""
        return float(student.ppf(1 - LEVEL / (2 * len(NAMES) * self.comparisons), len(self.numbers) - 1))

    def changes(self, later: Array, since: str) -> list[Change]:
        """What differs in a later run's numbers (4,) beyond the repeatability."""
        moved, width = (later - self.numbers.mean(axis=0)) / self.scale, self.quantile * self.error
        return [
            Change(name, float(d), float(w), since)
            for name, d, w in zip(NAMES, moved, width, strict=True)
            if abs(d) > w
        ]

    def found_by(self, chance: float) -> Array:
        """Relative changes (4,) that one comparison finds with this chance, if the scatter measured is the true one."""
        quantile, freedom = self.quantile, len(self.numbers) - 1

        def short(distance: float) -> float:
            return float(nct.sf(quantile, freedom, distance)) - chance

        return float(root_scalar(short, bracket=(0.0, 10.0 * quantile)).root) * self.error

    @property
    def words(self) -> str:
        """One line for a person: the scatter, and what would be found."""
        spread, found = (
            ", ".join(f"{name} {_told(name, value)}" for name, value in zip(NAMES, values, strict=True))
            for values in (self.error, self.found_by(0.9))
        )
        return f"the reference repeats within (standard deviation): {spread}; a drift is found with 90 % from: {found}"


def sentinel(
    motion: Sine, count: int, comparisons: int, told: Callable[[str], None]
) -> Callable[[Sequence[Path]], list[str]]:
    """A function that compares the last of the reference runs with the first `count`, and gives a line for each change.

    told hears once how well the first ones repeat. Each film is tracked once.
    """
    known: dict[Path, Array] = {}
    repeats: list[ReferenceRuns] = []

    def changed(runs: Sequence[Path]) -> list[str]:
        for path in (*runs[:count], runs[-1]):
            if path not in known:
                known[path] = sentinel_numbers(tracked(read_run(path)), motion)
        if not repeats:
            repeats.append(ReferenceRuns(np.array([known[path] for path in runs[:count]]), comparisons))
            told(repeats[0].words)
        if len(runs) <= count:
            return []
        return [change.words for change in repeats[0].changes(known[runs[-1]], runs[0].stem)]

    return changed
