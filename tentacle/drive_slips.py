"""What a recording says of what moves the arm, where it may be incomplete: a servo's log that ends before the pictures,
a hand's release that is not declared, a payload in grams. All of it is advice.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tentacle.base_motion import FEWEST_SAMPLES, fit_base_motion
from tentacle.log_end import log_ends
from tentacle.recording import Recording
from tentacle.signals import Array, MotorSignal
from tentacle.slip import Slip

STILL = 0.15  # of the farthest that it moves later: how far an arm strays that a hand holds at one place; it may ring
FEWEST_STILL = 10  # frames of an arm that is held
SURELY_HELD = 0.7  # of the time until it has moved half as far as it will, which a swing does in T/6, and T/2 is held
MOSTLY_SEEN = 0.9  # of the frames: a point that is seen as often has a path
HEAVIEST = 10.0  # arm masses: no soft arm carries as much, and 1000 times a payload of a hundredth is as much


def drive_slips(recording: Recording) -> list[Slip | None]:
    """Advice on the servo's log, the release and the payload."""
    motor = recording.motor
    log = [] if motor is None else _log_slips(recording, motor)
    return [*log, _release_slip(recording), _payload_slip(recording)]


def _log_slips(recording: Recording, motor: MotorSignal) -> list[Slip]:
    """A servo's log that begins or ends while the arm is seen, and what becomes of the pictures beyond it."""
    pictures = recording.midline or recording.markers or recording.shape
    if pictures is None or len(motor.t) < FEWEST_SAMPLES:
        return []
    t, found = pictures.t, list[Slip]()
    ends = log_ends(float(motor.t[0]), float(motor.t[-1]), t)
    if not ends:
        return []
    motion = fit_base_motion(motor)
    for end in ends:
        moves = not motion.rests_at(end.t, len(t))
        if not end.matters(moves):
            continue
        side, beyond = ("after", t > end.t) if end.verb == "ends" else ("before", t < end.t)
        count = f"{int(beyond.sum())} of {len(t)}"
        theta, rate, _ = motion(end.t)
        if moves:
            what = f"the servo turns there, {rate:.2g} rad/s: the pictures {side} it are left out, {count}"
        else:
            what = f"the servo rests there: for the pictures {side} it, {count}, it is taken to rest at {theta:.3g} rad"
        found.append(Slip("motor.csv", "t_s", f"{end.words}; {what}", "the servo's log while the arm is seen", False))
    return found


def _release_slip(recording: Recording) -> Slip | None:
    """An arm that hardly moves and then swings far, and nothing declared moves it: a free decay without [release].

    A free decay from the first picture on only loses energy, so that its largest swing is the first one.
    """
    declaration = recording.declaration
    if recording.motor is not None or recording.travel is not None or declaration.release_t is not None:
        return None
    seen = _farthest_path(recording)
    onset = None if seen is None else _onset(*seen)
    if onset is None:
        return None
    words = f"the arm hardly moves, {1e3 * onset.strays:.2g} mm about one place, until {onset.time:.4g} s, and then"
    words += f" {1e3 * onset.moves:.3g} mm away from it; nothing that is declared moves it"
    declare = f"[release] t_s = {{ value = {onset.time:.4g}, sd = {onset.sd:.2g} }} if a hand let it go then"
    other = "not so if it is driven (by a servo: motor.csv, by its base: base.csv, by an actuator of its own)"
    return Slip("recording.toml", "release", words, f"{declare}; {other}", False)


@dataclass(frozen=True)
class Onset:
    """The end of a rest: time and sd [s]; how far the point strays before it and moves after it [m]."""

    time: float
    sd: float
    strays: float
    moves: float


def _onset(t: Array, path: Array) -> Onset | None:
    """The onset of the motion of a path (T, 2) [m] that begins with a rest for longer than the first swing lasts."""
    away = np.linalg.norm(path - np.median(path[:FEWEST_STILL], axis=0), axis=1)
    half = int(np.argmax(away > 0.5 * away.max()))
    held = path[: int(SURELY_HELD * half)]
    if len(held) < FEWEST_STILL:
        return None
    away = np.linalg.norm(path - np.median(held, axis=0), axis=1)
    strays, farthest = float(away[: len(held)].max()), int(np.argmax(away))
    begun = int(np.flatnonzero(away[: half + 1] <= strays)[-1])
    time, moves = float(t[begun]), float(away[farthest])
    if strays > STILL * moves or time - float(t[0]) < float(t[farthest]) - time:
        return None
    spread = max(2.0 * float(np.median(np.diff(t))), 0.5 * (float(t[half]) - time))
    return Onset(time, spread, strays, moves)


def _farthest_path(recording: Recording) -> tuple[Array, Array] | None:
    """Times (T,) and path (T, 2) [m] of the point that moves farthest, of those that are seen nearly always."""
    pictures = recording.midline or recording.markers
    if pictures is None:
        return None
    there = np.isfinite(pictures.xy[..., 0])
    steady = np.flatnonzero(there.mean(axis=0) >= MOSTLY_SEEN)
    if not steady.size or len(pictures.t) < 2 * FEWEST_STILL:
        return None
    spread = np.linalg.norm(np.nanstd(pictures.xy[:, steady], axis=0), axis=1)
    point = int(steady[int(np.argmax(spread))])
    return pictures.t[there[:, point]], pictures.xy[there[:, point], point]


def _payload_slip(recording: Recording) -> Slip | None:
    """A payload that is many times as heavy as the arm."""
    specimen = recording.declaration.specimen
    times = specimen.tip_mass / specimen.mass
    if times < HEAVIEST:
        return None
    seen = f"{specimen.tip_mass:g} kg is {times:.3g} times the mass of the arm itself, {1e3 * specimen.mass:.3g} g"
    return Slip(
        "recording.toml", "specimen.tip_mass_kg", seen, "kilograms (are these grams? then multiply by 0.001)", False
    )
