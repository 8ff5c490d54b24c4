"""Where the pictures show a place of the arm, and in which direction it points there, to some degrees; without a model.

Between points that are seen, places lie on straight lines, and the direction of a chord is that of the arm at its
middle. Beyond the last chord the direction goes on as it changed before.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tentacle.recording import Recording
from tentacle.signals import Array

CHORDS = 8  # of a midline: shorter ones have the noise of its points, longer ones no shape
SAME_PLACE = 0.02  # of the arm: markers that are nearer count as one
FEWEST_FRAMES = 20


@dataclass(frozen=True)
class SeenArm:
    """t (T,) [s]; s (P,) of points from the clamp on, xy (T, P, 2) [m]; middles (K,) of chords, in s, and their
    directions angles (T, K) [rad], less what points beside the axis add.
    """

    t: Array
    s: Array
    xy: Array
    middles: Array
    angles: Array

    def place(self, s: float) -> Array:
        """xy (T, 2) [m] at s."""
        return _between(self.s, np.moveaxis(self.xy, 1, -1), s)

    def direction(self, s: float) -> Array:
        """phi (T,) [rad] at s."""
        return _between(self.middles, self.angles, s)

    def bend(self, s: float) -> Array:
        """d phi / ds (T,) [rad] at s, of a parabola through the directions (a line through two)."""
        powers = np.vander(self.middles, min(3, len(self.middles)), increasing=True)
        coefficients = np.linalg.lstsq(powers, self.angles.T)[0]
        slopes = np.arange(1, len(coefficients)) * s ** np.arange(len(coefficients) - 1.0)
        return np.asarray(slopes @ coefficients[1:])


def seen_arm(recording: Recording) -> SeenArm | None:
    """What midline or markers show of the arm; None where they show too little. Points are counted from the base."""
    points = _points(recording)
    if points is None:
        return None
    t, (s, d), xy = points
    whole = np.isfinite(xy).all(axis=(1, 2))
    if whole.sum() < FEWEST_FRAMES or not s.size:
        return None
    t, xy = t[whole], xy[whole]
    s, d, xy = np.append(0.0, s), np.append(0.0, d), np.concatenate([np.zeros((len(t), 1, 2)), xy], axis=1)
    chords = np.diff(xy, axis=1)
    beside = np.arctan2(-np.diff(d), np.diff(s) * recording.declaration.specimen.length)
    angles, middles = np.arctan2(-chords[..., 0], chords[..., 1]) - beside, 0.5 * (s[1:] + s[:-1])
    if len(middles) == 1:  # the root points as the servo turns it
        motor = recording.motor
        root = np.zeros(len(t)) if motor is None else np.interp(t, motor.t, motor.angle)
        angles, middles = np.stack([root, angles[:, 0]], axis=1), np.append(0.0, middles)
    return SeenArm(t, s, xy, middles, np.unwrap(angles, axis=1))


def _points(recording: Recording) -> tuple[Array, tuple[Array, Array], Array] | None:
    """Times (T,), places s and d (P,), xy (T, P, 2) of some points of the arm in the order of their s."""
    midline, markers = recording.midline, recording.markers
    if midline is not None:
        wanted = np.arange(1, CHORDS + 1) / CHORDS
        at = np.unique(np.abs(midline.s[None, :] - wanted[:, None]).argmin(axis=1))
        at = at[midline.s[at] > SAME_PLACE]
        return midline.t, (midline.s[at], np.zeros(len(at))), midline.xy[:, at]
    if markers is None:
        return None
    order = [k for k in np.argsort(markers.s, kind="stable") if markers.s[k] > SAME_PLACE]
    groups: list[list[int]] = []
    for k in order:
        if groups and markers.s[k] - markers.s[groups[-1][0]] <= SAME_PLACE:
            groups[-1].append(k)
        else:
            groups.append([k])
    if not groups:
        return None
    s, d = (np.array([values[group].mean() for group in groups]) for values in (markers.s, markers.d))
    return markers.t, (s, d), np.stack([markers.xy[:, group].mean(axis=1) for group in groups], axis=1)


def _between(at: Array, values: Array, s: float) -> Array:
    """values (..., K) at places (K,), on straight lines, at s; the last line goes on."""
    k = int(np.clip(np.searchsorted(at, s) - 1, 0, len(at) - 2))
    share = (s - at[k]) / (at[k + 1] - at[k])
    return np.asarray((1.0 - share) * values[..., k] + share * values[..., k + 1])
