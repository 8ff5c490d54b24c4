"""Midlines of a free, slender body in a recording, from silhouettes: coiled frames are rejected with a reason."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from tentacle.signals import Array
from vision.body_evidence import STRANGE_WIDTH, dirt_at_an_end, length_doubts, width_doubts
from vision.frames import Frame
from vision.silhouette import Axis, find_ends, mean_axis, silhouette

BODY_POINTS = 52
LENGTH_TOLERANCE = 0.15  # of the recording's median
WIDTH_TOLERANCE = 0.35
HOLE = 0.02  # of the body's area


@dataclass(frozen=True)
class BodyTrack:
    """t (T,) [s]; midline (T, P, 2) and width (T, P) [px], NaN where not accepted; reason (T,), "" where accepted.

    affine_rms (T,) [px]: distance of the midline from the best curve of affine curvature, with free place, heading and
    length.
    """

    t: Array
    midline: Array
    width: Array
    reason: tuple[str, ...]
    affine_rms: Array

    @property
    def accepted(self) -> NDArray[np.bool_]:
        """(T,) True where the midline can be trusted."""
        return np.array([not reason for reason in self.reason])

    def words(self) -> str:
        """Whether the affine model describes this body."""
        kept = self.accepted
        if not kept.any():
            return "no midline was accepted"
        rms, width = float(np.median(self.affine_rms[kept])), float(np.median(self.width[kept].max(axis=1)))
        verdict = "is bad" if rms > 0.1 * width else "is good"
        return f"the affine fit {verdict} here: it leaves {rms:.2f} px (median rms) of a body {width:.1f} px wide"


def track_body(frames: Iterable[Frame], polarity: float | None = None) -> BodyTrack:
    """Midline of the largest body in each frame; accepted if its length and width are usual for the recording.

    A body that touches itself has a hole in its silhouette, or an unusual length or width. body_evidence finds dirt
    that touches the body, or nearly touches one of its ends.
    """
    times, axes, reasons = [], [], []
    for frame in frames:
        seen = silhouette(frame.image, polarity, faint=True)
        axis, reason = None, ""
        if seen is None:
            reason = "no body found"
        elif seen.holes > HOLE * seen.area:
            reason = "coiled"
        else:
            axis = mean_axis(seen.contour, *find_ends(seen.contour), points=BODY_POINTS)
            reason = "something lies at an end" if dirt_at_an_end(axis, seen.beside) else ""
        times.append(frame.t)
        axes.append(axis)
        reasons.append(reason)
    lengths = [axis.length for axis in axes if axis is not None]
    widths = [np.quantile(axis.width, 0.9) for axis in axes if axis is not None]
    length, width = (float(np.median(lengths)), float(np.median(widths))) if lengths else (np.nan, np.nan)
    for k, axis in enumerate(axes):
        if axis is None:
            continue
        off = abs(axis.length / length - 1.0) > LENGTH_TOLERANCE
        if off or abs(np.quantile(axis.width, 0.9) / width - 1.0) > WIDTH_TOLERANCE:
            reasons[k] = "coiled or merged with something"
    lengthened, widened = length_doubts(axes), width_doubts(axes)
    for k in range(len(axes)):
        if not reasons[k] and lengthened[k] > STRANGE_WIDTH:
            reasons[k] = "longer than in the frames about it: something touches it"
        elif not reasons[k] and lengthened[k] < -STRANGE_WIDTH:
            reasons[k] = "shorter than in the frames about it: an end is not seen"
        elif not reasons[k] and widened[k] > STRANGE_WIDTH:
            reasons[k] = "not as wide as it is elsewhere: something touches it"
    kept = [axis if axis is not None and not reason else None for axis, reason in zip(axes, reasons, strict=True)]
    return BodyTrack(
        t=np.array(times),
        midline=np.array([np.full((BODY_POINTS, 2), np.nan) if axis is None else axis.points for axis in kept]),
        width=np.array([np.full(BODY_POINTS, np.nan) if axis is None else axis.width for axis in kept]),
        reason=tuple(reasons),
        affine_rms=np.array([np.nan if axis is None else polynomial_rms(axis, 2) for axis in kept]),
    )


def polynomial_rms(axis: Axis, order: int) -> float:
    """Rms distance [px] of an axis from the best curve whose curvature has order coefficients (eq. 1 at order 2)."""
    s = np.linspace(0.0, 1.0, len(axis.points))
    fine = np.linspace(0.0, 1.0, 4 * (len(s) - 1) + 1)
    powers = np.array([fine ** (j + 1) / (j + 1) for j in range(order)])
    heading = np.unwrap(np.arctan2(*np.gradient(axis.points, axis=0).T[::-1]))
    start = np.concatenate([axis.points[0], [axis.length], np.polynomial.polynomial.polyfit(s, heading, order)])
    start[4:] *= np.arange(1, order + 1)

    def residual(parameters: Array) -> Array:
        phi = parameters[3] + parameters[4:] @ powers
        step = parameters[2] * np.stack([np.cos(phi), np.sin(phi)], axis=1) / (len(fine) - 1)
        curve = parameters[:2] + np.concatenate([np.zeros((1, 2)), np.cumsum(0.5 * (step[1:] + step[:-1]), axis=0)])
        return (curve[::4] - axis.points).ravel()

    fit = least_squares(residual, start, method="lm", max_nfev=60)  # a rough shape measure: no exact minimum is needed
    return float(np.sqrt(2.0 * np.mean(fit.fun**2)))
