"""Slips of scale and order: where the pictures show points of the arm, beside where their s lets them be.

    |r(s)| <= hypot(s L, d) of a point of the arm, counted from the clamp; equal where the arm is straight.

A bend brings a point nearer: an arc that turns by the angle b has a chord of 2 sin(b/2) / b of it. A place that the
arm cannot reach is an error. One that it never comes near to may be a strong bend, so that this is advice, unless the
bend would be one that no arm keeps in every frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.stats import median_abs_deviation

from tentacle.recording import Recording
from tentacle.signals import Array, Markers
from tentacle.slip import Slip

MARKER_REACH = 1.15  # of s L: how far a marker may lie from the clamp, for roughly declared lengths and shifted clamps
STEADY = 0.1  # relative median deviation of a midline's length over the frames, beyond which it is no midline's
NEAR_MARKER = 0.4  # of the arm: the chord to a marker within it turns with the servo, whatever the arm's waves
FEWEST_FRAMES = 10
FARTHEST = 0.95  # quantile over the frames that counts as the farthest: a few points may be wrong
NEVER_NEAR = (
    0.6  # of hypot(s L, d): a point that is never as far lies on an arc that turns by 190 degrees in each frame
)
# The same where no bend explains it. An arc of .5 turns by 217 degrees, too much for the arm's root, one of .25 by 284.
TOO_NEAR = (0.5, 0.25)  # of the point next to the clamp: within NEAR_MARKER, beyond
LEAST_ARC = 0.1  # of the arm: nearer to the clamp, noise and the clamp's own place count
KNOWN_FACTORS = (2.54, 10.0, 25.4, 39.37, 100.0, 1000.0)  # of units that are confused
CLEAR = 0.15  # relative: how near to one of them a factor must lie to be named
SHARED = 0.2  # relative: markers whose distances are off by factors as alike have one wrong scale
OTHER_PLACE = 0.25  # of the distance between two places: as near to the other's place a marker fits it


@dataclass(frozen=True)
class SeenPlaces:
    """Points of the arm in a file: s (P,), arc [m] (P,) the distance from the clamp where the arm is straight, away
    (T, P) [m] the distance in each frame, NaN where a point is not seen.
    """

    file: str
    s: Array
    arc: Array
    away: Array

    @property
    def nearest(self) -> Array:
        """The least distance (P,) [m] of each."""
        return np.nanmin(self.away, axis=0)

    @property
    def middle(self) -> Array:
        """The median distance (P,) [m] of each."""
        return np.nanmedian(self.away, axis=0)

    @property
    def farthest(self) -> Array:
        """The distance (P,) [m] that each has at most, but for a few frames."""
        return np.nanquantile(self.away, FARTHEST, axis=0)


def place_slips(recording: Recording) -> list[Slip | None]:
    """Slips of scale and of order in midline and markers, which are counted from the base."""
    length = _length_slip(recording)
    found = [length, *_marker_slips(recording)]
    if any(found):
        return found
    return [_scale_slip(seen) for seen in (_points_of(recording), _markers_of(recording)) if seen is not None]


def spacing_slip(recording: Recording) -> Slip | None:
    """Points of which every two neighbours are farther apart, or nearer to each other, than the arm lets them be. Their
    distances do not depend on where the base is, so that a slip here is none of the base's path.
    """
    length = recording.declaration.specimen.length
    if recording.midline is not None:
        slip = _length_slip(recording)
        return slip if slip is not None and slip.certain else None
    markers = recording.markers
    if markers is None:
        return None
    order = np.argsort(markers.s, kind="stable")
    arc = np.hypot(np.diff(markers.s[order]) * length, np.diff(markers.d[order]))
    apart = np.linalg.norm(np.diff(markers.xy[:, order], axis=1), axis=2)
    kept = (arc > LEAST_ARC * length) & (np.isfinite(apart).sum(axis=0) >= FEWEST_FRAMES)
    if kept.sum() < 2:  # the s of one of two markers may be wrong
        return None
    farthest, arc = np.nanquantile(apart[:, kept], FARTHEST, axis=0), arc[kept]
    shares = farthest / arc
    alike = np.abs(shares / np.median(shares) - 1.0).max() < SHARED
    far = (farthest > MARKER_REACH * arc + 0.05 * length).all()
    if not alike or not (far or (shares < TOO_NEAR[0]).all()):
        return None
    k = int(np.argmax(arc))
    one, other = (markers.names[order[np.flatnonzero(kept)[k] + end]] for end in (0, 1))
    seen = f"{one} and {other} are {1e3 * farthest[k]:.3g} mm apart; on the arm they are {1e3 * arc[k]:.3g} mm apart"
    remedy = f"metres on the scale of specimen.length_m{factor_words(float(np.median(shares)))}"
    return Slip("markers.csv", "x_m, y_m", seen, remedy, True)


def path_slip(recording: Recording) -> Slip | None:
    """A path of the base that takes the arm's points farther from the clamp than the arm reaches; the recording's
    positions are counted from the base.
    """
    for seen in (_points_of(recording), _markers_of(recording)):
        if seen is None:
            continue
        beyond = seen.farthest / (MARKER_REACH * seen.arc + 0.05 * recording.declaration.specimen.length)
        k = int(np.argmin(beyond))
        if beyond[k] > 1.0:
            found, arc = f"{1e3 * seen.farthest[k]:.3g} mm from the clamp", f"{1e3 * seen.arc[k]:.3g} mm"
            words = f"without the base's path the point at s = {seen.s[k]:.3g} is up to {found}; on the arm it is {arc}"
            remedy = "the clamp's path in metres, in the axes of the markers, seen as [base] seen_from says"
            return Slip("base.csv", "x_m, y_m", words, remedy, True)
    return None


def factor_words(ratio: float) -> str:
    """ " (10 times too small?)" of positions that are a share `ratio` of what they should be, in words; "" where the
    factor is that of no unit.
    """
    factor = max(ratio, 1.0 / ratio)
    known = min(KNOWN_FACTORS, key=lambda one: abs(np.log(factor / one)))
    if abs(factor / known - 1.0) > CLEAR:
        return ""
    return f" ({known:g} times too {'small' if ratio < 1.0 else 'large'}?)"


def _points_of(recording: Recording) -> SeenPlaces | None:
    """The midline's points beyond the clamp; None where there are few frames of them."""
    midline, length = recording.midline, recording.declaration.specimen.length
    if midline is None:
        return None
    beyond = midline.s > 0.0
    return _seen("midline.csv", midline.s[beyond], midline.s[beyond] * length, midline.xy[:, beyond])


def _markers_of(recording: Recording) -> SeenPlaces | None:
    """The markers; None where there are few frames of one."""
    markers, length = recording.markers, recording.declaration.specimen.length
    if markers is None:
        return None
    return _seen("markers.csv", markers.s, np.hypot(markers.s * length, markers.d), markers.xy)


def _seen(file: str, s: Array, arc: Array, xy: Array) -> SeenPlaces | None:
    away = np.linalg.norm(xy, axis=2)
    away = np.where(np.isfinite(away), away, np.nan)
    kept = (np.isfinite(away).sum(axis=0) >= FEWEST_FRAMES) & (s >= LEAST_ARC)
    return SeenPlaces(file, s[kept], arc[kept], away[:, kept]) if kept.any() else None


def _scale_slip(seen: SeenPlaces) -> Slip | None:
    """Points of which none ever gets near to the distance at which it lies on a straight arm."""
    shares = seen.farthest / seen.arc
    if shares.max() >= NEVER_NEAR:
        return None
    last = int(np.argmax(seen.s))
    straight = f"{1e3 * seen.arc[last]:.3g} mm where the arm is straight"
    words = (
        f"the point at s = {seen.s[last]:.3g} is never farther from the clamp than {1e3 * seen.farthest[last]:.3g} mm"
    )
    first = int(np.argmin(seen.s))
    certain = bool(shares[first] < TOO_NEAR[0 if seen.s[first] <= NEAR_MARKER else 1])
    remedy = f"metres on the scale of specimen.length_m{factor_words(float(np.median(shares)))}"
    return Slip(seen.file, "x_m, y_m", f"{words}, and {straight}", remedy, certain)


def _length_slip(recording: Recording) -> Slip | None:
    """A midline with another length than the declared one."""
    midline, length = recording.midline, recording.declaration.specimen.length
    if midline is None or len(midline.s) < 6:
        return None
    steps = np.linalg.norm(np.diff(midline.xy, axis=1), axis=2).sum(axis=1)
    share = float(midline.s[-1] - midline.s[0])
    measured = steps[np.isfinite(steps)] / max(share, 1e-9)
    if measured.size < 10:
        return None
    if median_abs_deviation(measured) > STEADY * np.median(measured):
        return None
    ratio = float(np.median(measured)) / length
    spread = next((n.spread for n in recording.declaration.uncertain if n.field == "specimen.length_m"), 0.0)
    allowed = max(0.03, 3.0 * spread / length)  # chords and noise change a midline's length by less than 3 %
    if abs(ratio - 1.0) < allowed:
        return None
    seen = f"the midline is {1e3 * ratio * length:.1f} mm long, the arm is declared {1e3 * length:.1f} mm"
    certain = not 0.5 < ratio < 2.0
    remedy = f"one length (is the scale off, or the length?){factor_words(ratio) if certain else ''}"
    return Slip("recording.toml", "specimen.length_m", seen, remedy, certain)


def _marker_slips(recording: Recording) -> list[Slip]:
    """Markers farther from the clamp than the arm reaches, or in another order than their s."""
    markers, length = recording.markers, recording.declaration.specimen.length
    if markers is None:
        return []
    away = np.linalg.norm(markers.xy, axis=2)
    away = np.where(np.isfinite(away), away, np.nan)
    seen = np.isfinite(away).any(axis=0)
    away = np.where(seen, away, np.inf)  # so that no row is empty; an unseen one is left out below
    nearest, middle = np.nanmin(away, axis=0), np.nanmedian(away, axis=0)
    arc = np.hypot(markers.s * length, markers.d)
    far = seen & (nearest > MARKER_REACH * arc + 0.05 * length)
    if far.sum() > 1 and (far == seen).all() and (arc[seen] > 0.0).all():
        shares = middle[seen] / arc[seen]
        ratio = float(np.median(shares))
        if np.abs(shares / ratio - 1.0).max() < SHARED:
            words = f"all markers are about {ratio:.3g} times as far from the clamp as their s lets them be"
            remedy = f"metres on the scale of specimen.length_m{factor_words(ratio)}"
            return [Slip("markers.csv", "x_m, y_m", words, remedy, True)]
    found = []
    for k in np.flatnonzero(far):
        words = f"never nearer to the clamp than {1e3 * nearest[k]:.1f} mm, at s = {markers.s[k]:.3g}"
        remedy = f"its place along the arm{_fitting_words(markers, middle / length, int(k))}"
        words = f"{words} of {1e3 * length:.0f} mm"
        found.append(Slip("recording.toml", f"markers.{markers.names[k]}.s", words, remedy, True))
    return found + _order_slips(markers, np.where(seen, middle, np.nan), length)


def _fitting_words(markers: Markers, places: Array, k: int) -> str:
    """Which s the distance of marker k fits, and which marker it looks exchanged with; places (M,): distance / L."""
    if places[k] > MARKER_REACH:
        return f"; its distance fits no s of this arm{factor_words(float(places[k] / max(markers.s[k], 1e-9)))}"
    words = f"; its distance fits s = {places[k]:.2g}"
    apart = np.abs(markers.s - markers.s[k])
    mutual = (np.abs(places[k] - markers.s) < OTHER_PLACE * apart) & (
        np.abs(places - markers.s[k]) < OTHER_PLACE * apart
    )
    if not mutual.any():
        return words
    return f"{words} ({markers.names[k]} and {markers.names[int(np.argmax(mutual))]} exchanged?)"


def _order_slips(markers: Markers, middle: Array, length: float) -> list[Slip]:
    """Neighbours along the arm of which the farther one is nearer to the clamp; middle (M,) [m]: median distances."""
    order, found = np.argsort(markers.s, kind="stable"), list[Slip]()
    for first, second in pairwise(order):
        apart = (markers.s[second] - markers.s[first]) * length
        if apart > 0.1 * length and middle[second] < middle[first] - OTHER_PLACE * apart:
            one, other = markers.names[first], markers.names[second]
            distances = f"({1e3 * middle[second]:.0f} and {1e3 * middle[first]:.0f} mm)"
            words = f"{other} is nearer to the clamp than {one} {distances}"
            remedy = "s in the order of the markers along the arm"
            found.append(Slip("recording.toml", "markers", words, remedy, False))
    return found
