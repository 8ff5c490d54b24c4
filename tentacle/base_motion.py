"""The base's motion from samples of the servo angle: a quintic spline whose number of knots the samples decide.

The arm is driven by theta's acceleration, and a second difference of samples is mostly noise. So theta is the quintic
spline of least squares (three continuous derivatives more than the arm needs) on knots spread evenly over the samples.
Generalised cross-validation (Craven and Wahba 1979) chooses the number of knots: too few knots distort the motion, too
many follow the noise. If the largest number is best, the samples have no noise and are interpolated. On a multisine at
50 to 1000 Hz with 1e-5 to 5e-3 rad of noise the acceleration's error was within 1.5 times that of the best number of
knots; smoothing splines of the same degree, their weight by restricted likelihood, were 3 to 60 times off.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import BSpline, make_interp_spline
from scipy.linalg import solveh_banded

from tentacle.errors import InputError
from tentacle.recording import Recording
from tentacle.signals import Array, BaseTravel, MotorSignal

SPLINE_DEGREE = 5
FEWEST_SAMPLES = SPLINE_DEGREE + 1
REST_MARGIN = 1.0  # s beyond the first and last sample in which the base comes to rest, for a time offset
STOPPING = 0.05  # s, the time constant of that
FEWEST_INTERVALS = 2
RESTS = 0.05  # of the rms rate: a base slower than that at the log's end rests there
INTERVAL_RATIO = 1.15  # factor between the numbers of knot intervals that are tried
SAMPLES_PER_INTERVAL = 2  # the finest one before interpolation


@dataclass(frozen=True)
class BaseMotion:
    """A waveform through samples: called with t (...) [s] it gives theta, rate and acceleration (3, ...).

    start, stop [s]: where samples are; noise [rad]: the standard deviation of the samples about it, 0 where clean.
    """

    spline: BSpline
    start: float
    stop: float
    noise: float

    def __call__(self, t: ArrayLike) -> Array:
        """Theta [rad], rate and acceleration at t. InputError farther than MARGIN outside the samples."""
        t = np.asarray(t, dtype=float)
        if t.size and (t.min() < self.start - REST_MARGIN or t.max() > self.stop + REST_MARGIN):
            raise InputError(
                f"the servo's angle is asked for from {t.min():.4g} to {t.max():.4g} s",
                field="motor",
                expected=f"times from {self.start:.4g} to {self.stop:.4g} s, where it was measured",
            )
        inside = np.clip(t, self.start, self.stop)
        theta, rate, acceleration = (self.spline(inside, derivative) for derivative in range(3))
        beyond = t - inside
        fading = np.exp(-np.abs(beyond) / STOPPING)
        return np.stack(
            [
                theta + rate * STOPPING * np.sign(beyond) * (1.0 - fading),
                rate * fading,
                np.where(beyond == 0.0, acceleration, -np.sign(beyond) * rate * fading / STOPPING),
            ]
        )

    def rests_at(self, end: float, frames: int) -> bool:
        """Whether the base hardly turns at an end of its log, beside how it turns on average; frames: of the pictures
        that show it, each four times sampled for the average.
        """
        usual = float(np.sqrt(np.mean(self(np.linspace(self.start, self.stop, 4 * frames))[1] ** 2)))
        return abs(float(self(end)[1])) <= RESTS * usual


@dataclass(frozen=True)
class HeldOutside:
    """A base motion that is known from first to last [s]. Before and after, the base stands still."""

    motion: BaseMotion
    first: float
    last: float

    def __call__(self, t: ArrayLike) -> Array:
        """theta, rate, acceleration (3, ...), not to be written to: a fit asks for the same times again and again."""
        times = np.asarray(t, dtype=float)
        return _held_outside(self, times.tobytes()).reshape(3, *times.shape)


@lru_cache(maxsize=24)  # eight of each: the base's angle, x and y
def _held_outside(base: HeldOutside, times: bytes) -> Array:
    t = np.frombuffer(times)
    table = np.array(base.motion(np.clip(t, base.first, base.last)))
    table[1:] *= (t >= base.first) & (t <= base.last)
    table.flags.writeable = False
    return table


@dataclass(frozen=True)
class Travel:
    """The path of a travelling base: called with t (...) [s] it gives x, y [m], their rates and accelerations (6, ...).
    Outside first and last [s] the base stands still.
    """

    x: HeldOutside
    y: HeldOutside

    @property
    def first(self) -> float:
        """Where the path begins to be known [s]."""
        return self.x.first

    @property
    def last(self) -> float:
        """Where it ends [s]."""
        return self.x.last

    def __call__(self, t: ArrayLike) -> Array:
        """x, y, rates, accelerations at t."""
        return np.stack([self.x(t), self.y(t)], axis=1).reshape(6, *np.shape(t))


def fit_travel(travel: BaseTravel) -> Travel:
    """The motion fitted to a base's measured path; InputError with fewer samples than a quintic needs (6)."""
    first, last = float(travel.t[0]), float(travel.t[-1])
    return Travel(*(HeldOutside(fit_samples(travel.t, along, "base"), first, last) for along in travel.xy.T))


def seen_from_base(recording: Recording, travel: Travel | None) -> Recording:
    """The recording with its points counted from the base, if the base travels and they are counted from the ground."""
    if travel is None or recording.declaration.seen_from == "base":
        return recording
    midline, markers = recording.midline, recording.markers
    if midline is not None:
        midline = replace(midline, xy=midline.xy - travel(midline.t)[:2].T[:, None])
    if markers is not None:
        markers = replace(markers, xy=markers.xy - travel(markers.t)[:2].T[:, None])
    declaration = replace(recording.declaration, seen_from="base")
    return replace(recording, declaration=declaration, midline=midline, markers=markers)


def fit_base_motion(motor: MotorSignal) -> BaseMotion:
    """The motion fitted to the measured angle; InputError with fewer samples than a quintic needs (6)."""
    return fit_samples(motor.t, motor.angle)


def fit_samples(t: Array, angle: Array, field: str = "motor") -> BaseMotion:
    """The motion fitted to samples at rising times t (N,) [s], angle (N,) [rad]; InputError, naming the field, with
    fewer than 6.
    """
    if len(t) < FEWEST_SAMPLES:
        raise InputError(f"{len(t)} samples", field=field, expected=f"at least {FEWEST_SAMPLES}")
    start, stop = float(t[0]), float(t[-1])
    tried = _interval_counts(len(t))
    splines = [_least_squares(t, angle, _knots(t, count)) for count in tried]
    scores = [_cross_validation(t, angle, spline) for spline in splines]
    best = int(np.argmin(scores)) if scores else -1
    if best == len(scores) - 1:
        return BaseMotion(make_interp_spline(t, angle, k=SPLINE_DEGREE), start, stop, 0.0)
    squares, free = _residual(t, angle, splines[best])
    return BaseMotion(splines[best], start, stop, float(np.sqrt(squares / free)))


def _interval_counts(samples: int) -> NDArray[np.int64]:
    most = (samples - SPLINE_DEGREE) // SAMPLES_PER_INTERVAL
    if most < FEWEST_INTERVALS:
        return np.empty(0, dtype=np.int64)
    steps = int(np.log(most / FEWEST_INTERVALS) / np.log(INTERVAL_RATIO)) + 2
    return np.unique(np.geomspace(FEWEST_INTERVALS, most, steps).astype(np.int64))


def _knots(t: Array, intervals: int) -> Array:
    """Knots evenly spread over the samples, not over time, so that every interval has samples even with gaps."""
    inner = np.interp(np.linspace(0, len(t) - 1, intervals + 1)[1:-1], np.arange(len(t)), t)
    return np.concatenate([np.full(SPLINE_DEGREE + 1, t[0]), inner, np.full(SPLINE_DEGREE + 1, t[-1])])


def _least_squares(t: Array, angle: Array, knots: Array) -> BSpline:
    """The spline of least squares by its banded normal equations; their condition is that of B-splines, about 1e5."""
    design = BSpline.design_matrix(t, knots, SPLINE_DEGREE)
    gram = design.T @ design
    bands = np.zeros((SPLINE_DEGREE + 1, gram.shape[0]))
    for offset in range(SPLINE_DEGREE + 1):
        bands[SPLINE_DEGREE - offset, offset:] = gram.diagonal(offset)
    return BSpline(knots, solveh_banded(bands, design.T @ angle), SPLINE_DEGREE)


def _residual(t: Array, angle: Array, spline: BSpline) -> tuple[float, int]:
    """Sum of squares, and the degrees of freedom that are left."""
    residual = angle - spline(t)
    rounding = len(t) * (np.finfo(float).eps * np.abs(angle).max()) ** 2
    return max(float(residual @ residual), rounding, 1e-300), len(t) - len(spline.c)


def _cross_validation(t: Array, angle: Array, spline: BSpline) -> float:
    """The logarithm of the generalised cross-validation score, n RSS / (n - p)^2."""
    squares, free = _residual(t, angle, spline)
    return float(np.log(squares) - 2.0 * np.log(free))
