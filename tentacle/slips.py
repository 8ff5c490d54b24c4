"""Slips of sign, unit and order in a recording, found before anything slow begins.

The recording is compared with the motion that every arm must have. The root points along the base, so that

    direction of the root = theta + a constant near 0,   turning with the servo by .35 to 1.5 rad a radian,

and a marker of arc length s lies within s L of the clamp (tentacle.place_slips). A slip without any other explanation
is an error. If an unusual set-up could explain it, it is advice, with the numbers behind it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tentacle.base_motion import FEWEST_SAMPLES, fit_travel, seen_from_base
from tentacle.drive_slips import drive_slips
from tentacle.errors import InputError
from tentacle.io.video_file import count_frames, frame_rate
from tentacle.place_slips import NEAR_MARKER, path_slip, place_slips, spacing_slip
from tentacle.recording import Recording
from tentacle.sensor_slips import sensor_slips
from tentacle.signals import Array
from tentacle.slip import Slip
from tentacle.travel_slips import axes_slip, log_slips

NEAR_ROOT = 0.15  # of the arm: within, the midline's direction is the base's to some degrees
SLOWEST = 1.0  # s between pictures: too long for the motion of a soft arm
LEAST_SERVO_TURN = 0.05  # rad of the servo, below which its sign and unit cannot be seen
ONE_DEGREE = np.pi / 180.0
CONCENTRATED = 0.7  # mean resultant length of the root's directions: a swing of +-60 degrees has as much
FEWEST_PX = 20.0  # an arm shorter in the picture has no shape
MOST_PX = 20_000.0  # no camera's picture is as wide
MILLISECONDS = (300.0, 3000.0)  # a log that lasts as many times the pictures' span counts in other units


def refuse_slips(recording: Recording) -> None:
    """InputError for the first slip without another explanation."""
    for slip in find_slips(recording):
        if slip.certain:
            raise InputError(slip.seen, file=f"{recording.name}/{slip.file}", field=slip.field, expected=slip.remedy)


def find_slips(recording: Recording) -> list[Slip]:
    """All slips of a recording; none if too little was measured."""
    short = _short_logs(recording)
    if short:
        return short
    found, travel = [_slow_clock(recording), *_log_clocks(recording), _picture_slip(recording)], None
    found += drive_slips(recording)
    if recording.travel is not None:
        travel = fit_travel(recording.travel)
        found += log_slips(recording, recording.travel, travel)
        if (spacing := spacing_slip(recording)) is not None:
            return [spacing]
        axes, out_of_reach = axes_slip(recording, travel), path_slip(seen_from_base(recording, travel))
        if axes is not None and (axes.certain or (out_of_reach and recording.declaration.seen_from == "base")):
            return [replace(axes, certain=True)]
        if out_of_reach:
            return [out_of_reach]
        recording = seen_from_base(recording, travel)
        found.append(axes)
    root, chord = root_direction(recording), marker_direction(recording)
    if root is not None:
        found += [_root_slip("midline.csv", *root), _servo_slip(recording, *root)]
    if chord is not None:
        found.append(_root_slip("markers.csv", *chord[:2]))
        if chord[2] <= NEAR_MARKER:
            found.append(_servo_slip(recording, *chord[:2]))
    found += [*place_slips(recording), *sensor_slips(recording, travel)]
    return [slip for slip in found if slip is not None]


def _short_logs(recording: Recording) -> list[Slip]:
    """Logs of the base with too few samples for a motion, where the arm is seen: a run may end before it is."""
    if recording.midline is None and recording.markers is None and recording.video is None:
        return []
    logs = {"motor.csv": recording.motor, "base.csv": recording.travel}
    return [
        Slip(
            file,
            "t_s",
            "1 sample" if len(log.t) == 1 else f"{len(log.t)} samples",
            f"at least {FEWEST_SAMPLES}, while the arm is seen",
            True,
        )
        for file, log in logs.items()
        if log is not None and len(log.t) < FEWEST_SAMPLES
    ]


def _slow_clock(recording: Recording) -> Slip | None:
    pictures = recording.midline or recording.markers
    if pictures is None or len(pictures.t) < 3:
        return None
    interval = float(np.median(np.diff(pictures.t)))
    if interval < SLOWEST:
        return None
    name = "midline.csv" if recording.midline is not None else "markers.csv"
    return Slip(name, "t_s", f"a picture every {interval:.4g} s", "seconds (are these milliseconds?)", True)


def _log_clocks(recording: Recording) -> list[Slip]:
    """Logs in milliseconds beside pictures in seconds."""
    span, found = _seen_for(recording), list[Slip]()
    if span is None:
        return []
    for name, log in recording.logs.items():
        if not MILLISECONDS[0] * span < np.ptp(log.t) < MILLISECONDS[1] * span:
            continue
        seen = f"lasts {np.ptp(log.t):.4g} s, and the arm is seen for {span:.4g} s"
        found.append(Slip(f"{name}.csv", "t_s", seen, "seconds (are these milliseconds?)", True))
    return found


def _seen_for(recording: Recording) -> float | None:
    """Duration [s] for which the arm is seen: from midline or markers, else from the film's header; None if unknown."""
    pictures, video, camera = recording.midline or recording.markers, recording.video, recording.declaration.camera
    if pictures is not None:
        return float(np.ptp(pictures.t)) if len(pictures.t) >= 3 else None
    if video is None:
        return None
    frames = count_frames(video)
    if video.path.is_dir():
        rate = 0.0 if camera is None else camera.fps
    else:
        rate = frame_rate(video.path)
    return frames / rate if frames >= 3 and rate > 0.0 else None


def _picture_slip(recording: Recording) -> Slip | None:
    camera = recording.declaration.camera
    if camera is None:
        return None
    pixels = recording.declaration.specimen.length / camera.metres_per_px
    if FEWEST_PX <= pixels <= MOST_PX:
        return None
    seen = f"{camera.metres_per_px:g} m a pixel makes the arm {pixels:.3g} pixels long"
    return Slip("recording.toml", "camera.m_per_px", seen, "metres a pixel, some 0.0002 to 0.001", True)


def root_direction(recording: Recording) -> tuple[Array, Array] | None:
    """Times (T,) and direction (T,) [rad] of the midline near the clamp, phi = atan2(-x, y); None without a midline."""
    midline = recording.midline
    if midline is None:
        return None
    third = float(np.sort(midline.s)[min(2, len(midline.s) - 1)])
    near = np.flatnonzero((midline.s > 0.0) & (midline.s <= max(NEAR_ROOT, third)))
    points = midline.xy[:, near]
    whole = np.isfinite(points).all(axis=(1, 2))
    if near.size == 0 or whole.sum() < 10:
        return None
    vectors = points[whole].sum(axis=1)
    return midline.t[whole], np.unwrap(np.arctan2(-vectors[:, 0], vectors[:, 1]))


def marker_direction(recording: Recording) -> tuple[Array, Array, float] | None:
    """Times (T,) and direction (T,) [rad] of the chord from the clamp to the nearest marker, less its angle where the
    arm is straight, and the marker's s; None without markers.
    """
    markers, length = recording.markers, recording.declaration.specimen.length
    if markers is None:
        return None
    beside = np.abs(markers.d) <= 0.5 * markers.s * length  # the chord to one beside the clamp is not the arm's
    if not beside.any():
        return None
    nearest = int(np.argmin(np.where(beside, markers.s, np.inf)))
    s, d, xy = float(markers.s[nearest]), float(markers.d[nearest]), markers.xy[:, nearest]
    seen = np.isfinite(xy).all(axis=1)
    if seen.sum() < 10:
        return None
    straight = np.arctan2(-d, s * length)
    return markers.t[seen], np.unwrap(np.arctan2(-xy[seen, 0], xy[seen, 1])) - straight, s


def root_turning(theta: Array, direction: Array) -> float | None:
    """Rotation of the root per radian of the servo, d direction / d theta: 1 as declared, 0 in a frame that turns with
    the servo, -1 if the two have opposite signs. None if the servo hardly turns or there are few frames.
    """
    if theta.size < 10 or np.ptp(theta) < LEAST_SERVO_TURN:
        return None
    return float(np.polyfit(theta - theta.mean(), direction, 1)[0])


def _root_slip(file: str, t: Array, direction: Array) -> Slip | None:
    """A root that points along x, or against y, on average over the recording."""
    resultant = complex(np.mean(np.exp(1j * direction)))
    if abs(resultant) < CONCENTRATED:
        return None
    mean = float(np.angle(resultant))
    seen = f"the root points {np.degrees(mean):.0f} degrees away from y on average over {len(t)} frames"
    if abs(abs(mean) - 0.5 * np.pi) < 0.6:
        return Slip(file, "x_m", seen, "y along the straight arm, x across it (exchanged?)", True)
    if abs(mean) > np.pi - 0.6:
        return Slip(file, "y_m", seen, "y from the clamp towards the tip (its sign?)", True)
    return None


def _servo_slip(recording: Recording, t: Array, direction: Array) -> Slip | None:
    """A servo's log in degrees, or with the other sign, by how far the root turns with it."""
    motor = recording.motor
    if motor is None:
        return None
    within = (t >= motor.t[0]) & (t <= motor.t[-1])
    theta, phi = np.interp(t[within], motor.t, motor.angle), direction[within]
    slope = root_turning(theta, phi)
    if slope is None:
        return None
    agreement = float(np.corrcoef(theta, phi)[0, 1])
    seen = f"the root turns {slope:.3g} rad for a radian of the servo (correlation {agreement:.2f})"
    if agreement > 0.8 and 0.3 * ONE_DEGREE < slope < 3.0 * ONE_DEGREE:
        return Slip("motor.csv", "angle_rad", seen, "radians (these are degrees)", True)
    if agreement < -0.8 and slope < -0.35:
        other = "that of the pictures' x" if recording.declaration.camera is None else "declare mirrored"
        return Slip("motor.csv", "angle_rad", seen, f"the log's sign is reversed (or {other})", False)
    return None
