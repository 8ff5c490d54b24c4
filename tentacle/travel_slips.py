"""Slips in base.csv, the path of a base that travels: how long it lasts, and along which axes it is written.

    clamp(t) = r(s1, t) - L int_0^s1 (-sin phi, cos phi) ds,      phi(s, t) = theta(t) + b1(t) s + b2(t) s^2 + rest(s)

r(s1) is the point next to the clamp and phi the direction of the chords between the points. So the pictures alone show
how the clamp moves, without a model. It must move as base.csv says, or stand still if positions are counted from the
base.
"""

from __future__ import annotations

import numpy as np

from tentacle.base_motion import Travel
from tentacle.log_end import log_ends
from tentacle.place_slips import NEAR_MARKER
from tentacle.recording import Recording
from tentacle.signals import Array, BaseTravel
from tentacle.slip import Slip

LAST_TRAVEL = 0.1  # s, of a base's log, in which it is seen whether the base stands
STANDS = 0.005  # of the arm's length: how far a base that stands may move in it
CHORDS = 5  # of a midline, from its tenth on: shorter ones have the noise of its points
FIRST_POINT = 0.1  # of the arm, of a midline: nearer to the clamp the chord to it says nothing
FEWEST_FRAMES = 30
# Shares of the rms of the path: what is left of the clamp's motion if the path is read rightly, and wrongly. A reversed
# sign leaves 2, exchanged axes 1.4, the other seen_from 1. In 1500 simulated beams in air and water, shaken at .1 to 20
# times their first frequency and seen from ground and base, these bounds found no slip where there was none. They found
# 43 % of those that there were: a strong resonance hides them.
RIGHT, WRONG = 0.25, 0.7
MOST_LEVER = 1.0  # of the path's rms: how much the first point may move about the clamp and still show it
AS_GOOD = 0.05  # of the path's rms: readings that leave as little; the one with the fewest changes is named
READINGS: tuple[tuple[str, Array], ...] = (
    ("the sign of x_m reversed", np.array([[-1.0, 0.0], [0.0, 1.0]])),
    ("the sign of y_m reversed", np.array([[1.0, 0.0], [0.0, -1.0]])),
    ("x_m and y_m exchanged", np.array([[0.0, 1.0], [1.0, 0.0]])),
    ("both signs reversed", np.array([[-1.0, 0.0], [0.0, -1.0]])),
    ("x_m and y_m exchanged and the new x_m reversed", np.array([[0.0, -1.0], [1.0, 0.0]])),
    ("x_m and y_m exchanged and the new y_m reversed", np.array([[0.0, 1.0], [-1.0, 0.0]])),
    ("x_m and y_m exchanged and both signs reversed", np.array([[0.0, -1.0], [-1.0, 0.0]])),
)


def log_slips(recording: Recording, log: BaseTravel, travel: Travel) -> list[Slip]:
    """A path of the base that begins or ends while the arm is seen and the base moves."""
    pictures, found = recording.midline or recording.markers, list[Slip]()
    if pictures is None:
        return []
    length, noise = recording.declaration.specimen.length, float(np.std(log.xy - travel(log.t)[:2].T))
    for end in log_ends(travel.first, travel.last, pictures.t):
        inner = end.t - LAST_TRAVEL if end.verb == "ends" else end.t + LAST_TRAVEL
        path = travel(np.linspace(np.clip(inner, travel.first, travel.last), end.t, 20))[:2]
        moved = float(np.linalg.norm(path - path[:, -1:], axis=0).max())
        moves = moved > STANDS * length + 4.0 * noise
        if not end.matters(moves):
            continue
        seen = end.words
        if moves:
            seen += f"; the base moves there, {1e3 * moved:.3g} mm in {LAST_TRAVEL:g} s"
        remedy = "the base's path while the arm is seen (it is taken to stand before and after)"
        found.append(Slip("base.csv", "t_s", seen, remedy, moves))
    return found


def axes_slip(recording: Recording, travel: Travel) -> Slip | None:
    """A path of the base with a wrong sign, exchanged axes or a wrong seen_from, where another reading of it fits the
    pictures and this one does not. The recording's positions are as they were measured.
    """
    shown = seen_clamp(recording)
    if shown is None:
        return None
    t, clamp, lever = shown
    path = travel(t)[:2].T
    path, clamp = path - path.mean(axis=0), clamp - clamp.mean(axis=0)
    moved = _rms(path)
    if not moved > 0.0 or _rms(lever - lever.mean(axis=0)) > MOST_LEVER * moved:
        return None
    of_ground = _rms(clamp - path) / moved
    of_base = _rms(clamp) / moved
    from_base = recording.declaration.seen_from == "base"
    declared, other = (of_base, of_ground) if from_base else (of_ground, of_base)
    if declared < WRONG:
        return None
    file = "midline.csv" if recording.midline is not None else "markers.csv"
    words = (
        f"the clamp, as {file} shows it, moves otherwise than base.csv says: {declared:.2f} of the path's rms is left"
    )
    if other < RIGHT:
        named = ("base", "ground") if from_base else ("ground", "base")
        seen = f'{words} if it is seen from "{named[0]}", {other:.2f} if from "{named[1]}"'
        remedy = f'seen_from = "{named[1]}"' + ("?" if from_base else ", or base.csv in metres?")
        return Slip("recording.toml", "base.seen_from", seen, remedy, False)
    if from_base:
        return None
    left = np.array([_rms(clamp - path @ reading.T) / moved for _, reading in READINGS])
    if left.min() > RIGHT:
        return None
    best = int(np.argmax(left < left.min() + AS_GOOD))
    seen = f"{words}, {left[best]:.2f} with {READINGS[best][0]}"
    return Slip("base.csv", "x_m, y_m", seen, "the clamp's path in the axes of the pictures, with their signs", True)


def seen_clamp(recording: Recording) -> tuple[Array, Array, Array] | None:
    """Times (T,) [s], the clamp's place (T, 2) [m] as the pictures show it, up to a constant, and the first point's
    place about the clamp (T, 2) [m]. None where there are few frames or points, or none is near the clamp.
    """
    points = _points(recording)
    if points is None:
        return None
    t, s, xy = points
    whole = np.isfinite(xy).all(axis=(1, 2))
    if whole.sum() < FEWEST_FRAMES or len(s) < 3 or not 0.0 < s[0] <= NEAR_MARKER:
        return None
    t, xy = t[whole], xy[whole]
    chords, middles = np.diff(xy, axis=1), 0.5 * (s[1:] + s[:-1])
    angles = np.unwrap(np.arctan2(-chords[..., 0], chords[..., 1]), axis=1)
    motor = recording.motor
    theta = np.zeros(len(t)) if motor is None else np.interp(t, motor.t, motor.angle)
    theta = theta - theta.mean()
    usual = angles.mean(axis=0)  # the shape about which the arm moves
    bends = np.linalg.lstsq(np.stack([middles, middles**2], axis=1), (angles - usual - theta[:, None]).T)[0]
    near = s[0] * (np.arange(10) + 0.5) / 10.0
    phi = (
        theta[:, None] + (np.stack([near, near**2], axis=1) @ bends).T + np.polyval(np.polyfit(middles, usual, 1), near)
    )
    length = recording.declaration.specimen.length
    lever = s[0] * length * np.stack([-np.sin(phi).mean(axis=1), np.cos(phi).mean(axis=1)], axis=1)
    return t, xy[:, 0] - lever, lever


def _points(recording: Recording) -> tuple[Array, Array, Array] | None:
    """Times (T,), s (P,) rising and xy (T, P, 2) of points on the axis: of markers those that lie on it."""
    midline, markers = recording.midline, recording.markers
    if midline is not None:
        wanted = np.linspace(FIRST_POINT, 1.0, CHORDS + 1)
        at = np.unique(np.abs(midline.s[None, :] - wanted[:, None]).argmin(axis=1))
        return midline.t, midline.s[at], midline.xy[:, at]
    if markers is None:
        return None
    length = recording.declaration.specimen.length
    usual = [k for k in np.argsort(markers.s, kind="stable") if abs(markers.d[k]) <= STANDS * length]
    order = [k for i, k in enumerate(usual) if i == 0 or markers.s[k] - markers.s[usual[i - 1]] > STANDS]
    return markers.t, markers.s[order], markers.xy[:, order]


def _rms(values: Array) -> float:
    """Root of the mean square length of vectors (T, 2)."""
    return float(np.sqrt(np.mean(np.sum(values**2, axis=1))))
