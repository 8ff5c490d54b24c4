"""The signals of a recording: motor, load cell, midline, markers, sensors on the arm, video. Arrays in SI units, times
in seconds.

All positions are in the base frame: origin at the clamp, x along the normal n, y along the straight arm at
theta = 0. It stands still in the laboratory: when the servo turns the base by theta, the arm turns in this frame.
Where the base travels, the origin is where its path has x = y = 0.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tentacle.notebook import html_paragraph, html_table

Array = NDArray[np.float64]
RAREST_READING = 0.021  # s between readings of an accelerometer (inference.frame_readings: what it errs by then)


@dataclass(frozen=True)
class MotorSignal:
    """Servo: times (N,) [s], commanded angle (N,) [rad], measured angle theta (N,) [rad]."""

    t: Array
    command: Array
    angle: Array


@dataclass(frozen=True)
class LoadCellSignal:
    """Load cell at the base: times (N,) [s], thrust (N,) [N] along +y of the base frame."""

    t: Array
    thrust: Array


@dataclass(frozen=True)
class BaseTravel:
    """The path of a moving base: times (N,) [s], xy (N, 2) [m] in the laboratory's frame."""

    t: Array
    xy: Array


@dataclass(frozen=True)
class Midline:
    """Points of the central axis: t (T,), s (P,) in [0, 1], xy (T, P, 2) [m], sigma (T, P) [m] of each coordinate.

    Missing points are NaN. sigma is NaN where the source states none.
    """

    t: Array
    s: Array
    xy: Array
    sigma: Array


@dataclass(frozen=True)
class Markers:
    """Points fixed to the arm at (s, d), d [m] along the normal.

    t (T,) [s], names (M), s (M,), d (M,) [m], xy (T, M, 2) [m]; NaN where a marker was not seen.
    """

    t: Array
    names: tuple[str, ...]
    s: Array
    d: Array
    xy: Array


@dataclass(frozen=True)
class StrainGauge:
    """A gauge along the arm: the middle of it at s, d [m] from the midline along the normal; length [m] along the arm;
    sigma, the standard deviation of one reading (None: not known).

    strain = d times the mean of d phi / dS over its length. d = 1 m describes a sensor that tells curvature [1/m].
    """

    s: float
    d: float
    length: float = 0.0
    sigma: float | None = None

    def ends(self, length: float) -> tuple[float, float]:
        """Where it begins and ends, as shares of the arm's length [m]."""
        half = 0.5 * self.length / length
        return self.s - half, self.s + half


@dataclass(frozen=True)
class StrainSignal:
    """What strain gauges measure: t (T,) [s] on the pictures' clock, names (G), gauges (G), values (T, G); NaN where
    nothing was measured. A gauge's zero is not known: its values are right up to a constant.
    """

    t: Array
    names: tuple[str, ...]
    gauges: tuple[StrainGauge, ...]
    values: Array


@dataclass(frozen=True)
class Accelerometer:
    """One axis of an accelerometer on the arm, at (s, d), d [m] along the normal; sigma [m/s^2], the standard deviation
    of one reading (None: not known).

        f = (r'' - g) . axis,      normal (cos phi, sin phi) or tangent (-sin phi, cos phi)

    r: its place in the laboratory; g: gravity; phi: the arm's direction at s. The axes turn with the arm. An arm that
    hangs at rest reads 0 along the normal, and minus g along the tangent.
    """

    s: float
    d: float
    axis: Literal["normal", "tangent"]
    sigma: float | None = None


@dataclass(frozen=True)
class AccelerationSignal:
    """What accelerometers measure: t (T,) [s] on the pictures' clock, names (A), accelerometers (A), values (T, A)
    [m/s^2]; NaN where nothing was measured. The zero of an axis is not known: its values are right up to a constant.
    """

    t: Array
    names: tuple[str, ...]
    accelerometers: tuple[Accelerometer, ...]
    values: Array


@dataclass(frozen=True)
class Video:
    """A camera recording: a video file, or a folder of numbered PNG frames (then frame k is at k / camera.fps)."""

    path: Path


@dataclass(frozen=True)
class FrameShapes:
    """What each frame of a video tells of its shape by itself: coefficients (T, K) and covariance (T, K, K) as of a
    ShapeTrack. Its base angle is its own, and no coordinate that was fitted is held at zero.
    """

    coefficients: Array
    covariance: Array


@dataclass(frozen=True)
class ShapeTrack:
    """Shapes measured by vision: for each frame, coefficients with their full covariance.

    t (T,) [s]; coefficients (T, K): [base angle offset, q1 .. q_(K-1)] in the paper's monomial coordinates [rad],
    so that phi(s) = theta + offset + sum_j q_j s^j / j; covariance (T, K, K); accepted (T,) bool, False where the
    frame could not be trusted (then the row is NaN); reason (T,) one short phrase, "" where accepted. scale is the
    measured length over the declared one (1 = as declared) and scale_sigma its standard deviation; base_shift (2,) [m]
    is the clamp's place minus the declared one. The shapes are estimates: coordinates that the film does not need are
    held at zero, and the frames' base angles are drawn towards their mean. by_frames is without both (None: not known).
    """

    t: Array
    coefficients: Array
    covariance: Array
    accepted: NDArray[np.bool_]
    reason: tuple[str, ...]
    scale: float
    scale_sigma: float
    base_shift: Array
    by_frames: FrameShapes | None = None

    def measured(self) -> ShapeTrack:
        """The track whose shapes are measurements, for a model that states its own root and coordinates: what each
        frame tells by itself; this track where that is not known.
        """
        if self.by_frames is None:
            return self
        frames = self.by_frames
        return replace(self, coefficients=frames.coefficients, covariance=frames.covariance, by_frames=None)

    def _repr_html_(self) -> str:
        """The number of accepted frames, and each coordinate's range and standard deviation, for notebooks."""
        kept = np.flatnonzero(self.accepted)
        names = ("base angle offset", *(f"q{k}" for k in range(1, self.coefficients.shape[1])))
        rows = [
            (
                name,
                f"{self.coefficients[kept, k].min():.3f} to {self.coefficients[kept, k].max():.3f}",
                f"{np.sqrt(np.median(self.covariance[kept, k, k])):.2g}",
            )
            for k, name in enumerate(names)
            if kept.size
        ]
        title = f"{kept.size} of {len(self.t)} frames accepted; scale {self.scale:.4f} of the declared"
        return html_paragraph(title) + html_table(("coordinate [rad]", "range", "standard deviation"), rows)
