"""The drift sentinel: one motion, repeated, whose recordings are compared with each other and with no model.

The reference motion is a sine. In each of its periods a least-squares fit gives the mean, the swing and the lag of the
tip's heading against the base, and the swing of the thrust at twice the frequency. The scatter over periods is the
noise of their means. Two recordings differ in one of these numbers where Welch's t exceeds its quantile; the level is
shared among all comparisons of a campaign (Bonferroni).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import t as student

from rig.reidentify import tracked
from rig.run import Run
from tentacle.errors import InputError
from tentacle.recording import Recording
from tentacle.signals import Array
from tentacle.waveform import Sine

SETTLING = 3  # periods, until the arm repeats itself
FEWEST = 4  # periods that are compared
LEVEL = 0.01  # chance that a campaign without drift is told of one
COMPARISONS = 10  # of two recordings, in one campaign
REPEATS_WITHIN = 0.003  # of the swing, and rad of lag: how well a servo and a camera repeat one motion
NAMES = ("the tip's mean heading", "the tip's swing", "the tip's lag", "the thrust's swing")


@dataclass(frozen=True)
class Change:
    """What changed between two reference recordings: name, relative change (of the swing; of the lag in rad), and the
    half width of its interval.
    """

    name: str
    change: float
    half_width: float
    since: str

    @property
    def words(self) -> str:
        """One line for a person."""
        scale, unit = (1.0, " rad") if "lag" in self.name else (100.0, " %")
        low, high = scale * (self.change - self.half_width), scale * (self.change + self.half_width)
        return f"{self.name} changed by {scale * self.change:.3g}{unit} ({low:.3g} to {high:.3g}) since {self.since}"


def numbers_of(recording: Recording, motion: Sine) -> Array:
    """The four numbers (P, 4) of each period after settling: mean, swing [rad], lag [rad], swing of the thrust [N].

    InputError where fewer than FEWEST periods are seen.
    """
    shape, cell = recording.shape, recording.load_cell
    if shape is None or cell is None:
        raise InputError("has no shapes or no load cell", field=recording.name, expected="a filmed run of the rig")
    k = np.arange(1, shape.coefficients.shape[1])
    heading = shape.coefficients[:, 0] + (shape.coefficients[:, 1:] / k).sum(axis=1)
    tip = _harmonics(shape.t[shape.accepted], heading[shape.accepted], motion.frequency)
    pull = _harmonics(cell.t, cell.thrust, 2 * motion.frequency, per=2)
    count = min(len(tip), len(pull))
    if count < FEWEST:
        raise InputError(f"shows {count} whole periods", field=recording.name, expected=f"at least {FEWEST}")
    tip, pull = tip[:count], pull[:count]
    swing = np.hypot(tip[:, 1], tip[:, 2])
    lag = np.arctan2(-tip[:, 2], tip[:, 1])
    return np.column_stack([tip[:, 0], swing, lag, np.hypot(pull[:, 1], pull[:, 2])])


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


def changes(before: Array, after: Array, since: str, clock_sigma: float = 0.0) -> list[Change]:
    """What differs between two references' numbers (P, 4) beyond their noise; clock_sigma [rad]: of the lag alone."""
    swing = np.array([before[:, 1].mean(), before[:, 1].mean(), 1.0, before[:, 3].mean()])
    a, b = before / swing, after / swing
    spread = [x.var(axis=0, ddof=1) / len(x) for x in (a, b)]
    own = 2 * np.array([REPEATS_WITHIN, REPEATS_WITHIN, np.hypot(REPEATS_WITHIN, clock_sigma), REPEATS_WITHIN]) ** 2
    freedom = (spread[0] + spread[1] + own) ** 2 / sum(
        (s + own / 2) ** 2 / (len(x) - 1) for s, x in zip(spread, (a, b), strict=True)
    )
    width = student.ppf(1 - LEVEL / (2 * len(NAMES) * COMPARISONS), freedom) * np.sqrt(spread[0] + spread[1] + own)
    moved = b.mean(axis=0) - a.mean(axis=0)
    return [
        Change(name, float(d), float(w), since) for name, d, w in zip(NAMES, moved, width, strict=True) if abs(d) > w
    ]


def drift(runs: Sequence[Run], motion: Sine) -> list[Change]:
    """What the latest reference run shows that the first did not; nothing where there are fewer than two."""
    if len(runs) < 2:
        return []
    first, last = runs[0], runs[-1]
    clocks = [float((run.start.get("camera") or {}).get("offset_sigma_s", 0.0)) for run in (first, last)]
    sigma = 2 * np.pi * motion.frequency * float(np.hypot(clocks[0], clocks[1]))
    before, after = (numbers_of(tracked(run), motion) for run in (first, last))
    return changes(before, after, first.path.stem, sigma)
