"""Tracking a video: shapes with their full covariance, from the declared arm and the frames."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from tentacle.errors import InputError
from tentacle.recording import Declaration
from tentacle.signals import Array, MotorSignal, ShapeTrack
from tentacle.specimen import Cone
from vision.ahead import read_ahead
from vision.follow import Follower
from vision.frame_loop import follow_frames
from vision.frames import read_frames
from vision.kinematics import Geometry
from vision.lens import Lens
from vision.pool import COORDINATE_PENALTY, KnownBefore, Pooled, PoolResult, pool
from vision.remedy import Watch
from vision.servo_sign import check_sign
from vision.tracked_frame import TrackedFrame

TRACKED_ORDERS = (1, 2, 3, 4, 5)
SURE, WORTH_SAYING = 4.0, 2e-3  # sigmas, and relative: a larger error of the scale is reported
CAP_ALIKE = 0.15  # of the tip's radius: an excess of the length so near to it is the rounded cap
SHOWN_AGAIN = 0.2  # share of repeated pictures above which a film counts as slowed
# px by which the length may err where nobody says how far the tip is rounded. Half-round tips taken as flat ones:
# .25 px and .32 px for tips of 4 mm in rendered pictures of 320 x 240 and 640 x 360, .48 px for one of 1.8 px.
TIP_UNTOLD = 0.5
NO_OUTLINE = np.zeros((0, 2))


@dataclass(frozen=True)
class Tracking:
    """A tracked video: its shapes, every frame's own result, the pooled estimate, and remarks in words."""

    shape: ShapeTrack
    seen: tuple[TrackedFrame, ...]
    pooled: Pooled
    remarks: tuple[str, ...]


@dataclass(frozen=True)
class Following:
    """Options of tracking. order: number of curvature coordinates, 2 to 5; None: the data decide. lens: None for none.
    patience [s]: time to wait for more of a file that is still being written; see frames.read_frames. verdicts: frames
    that a person accepted or rejected (proofread). outlines: keep each frame's outline for an overlay; without them the
    memory grows by 2 kB a frame.
    """

    order: int | None = None
    lens: Lens | None = None
    patience: float = 0.0
    verdicts: Mapping[int, bool] | None = None
    outlines: bool = False


USUAL_FOLLOWING = Following()


def stream_tracking(
    video: Path, declaration: Declaration, motor: MotorSignal | None, following: Following = USUAL_FOLLOWING
) -> tuple[Follower, Iterator[TrackedFrame]]:
    """The follower, and an iterator over the frames' results; covariances are conditional on the g known so far."""
    if declaration.camera is None:
        raise InputError("the declaration has no camera", field="camera", expected="[camera] in recording.toml")
    if following.order is not None and following.order not in TRACKED_ORDERS:
        raise InputError(f"order {following.order} is not known", field="order", expected="1 to 5")
    camera = declaration.camera
    geometry = Geometry.declared(declaration.specimen, camera, following.lens)
    fitted = TRACKED_ORDERS[-1] if following.order is None else min(following.order + 1, TRACKED_ORDERS[-1])
    follower = Follower(geometry, camera.exposure, fitted, _angle(motor), following.verdicts)
    return follower, follow_frames(read_ahead(read_frames(Path(video), camera.fps, following.patience)), follower)


def track(
    video: Path,
    declaration: Declaration,
    motor: MotorSignal | None,
    order: int | None = None,
    lens: Lens | None = None,
    progress: Callable[[TrackedFrame], None] | None = None,
) -> ShapeTrack:
    """Shapes of the declared arm in a video (or folder of pictures); see ShapeTrack.

    motor gives theta(t), about which the base angle offset is measured; without it the offset is the base angle. order
    None: 2 to 5 curvature coordinates; the data decide. A frame's time is the middle of its exposure. progress is
    called with each frame's result. Raises InputError where the video cannot be read or shows no such arm.
    """
    return track_fully(video, declaration, motor, Following(order, lens), progress).shape


def track_fully(
    video: Path,
    declaration: Declaration,
    motor: MotorSignal | None,
    following: Following = USUAL_FOLLOWING,
    progress: Callable[[TrackedFrame], None] | None = None,
    warn: Callable[[str], None] | None = None,
) -> Tracking:
    """As track, with every frame's own result, the pooled estimate and remarks.

    warn is called at once if most of the first frames are lost, or if tracking is slow, with a proposal. Raises
    InputError also if the servo's log turns against the arm's root.
    """
    follower, results = stream_tracking(
        video, declaration, motor, Following(following.order, following.lens, following.patience, following.verdicts)
    )
    seen: list[TrackedFrame] = []
    watch = Watch()
    angle = _angle(motor)
    try:
        if angle is not None and not following.patience and not Path(video).is_char_device():
            assert declaration.camera is not None
            check_sign(read_frames(Path(video), declaration.camera.fps), follower.geometry, angle)
        for result in results:
            seen.append(result if following.outlines else replace(result, outline_px=NO_OUTLINE))
            if progress is not None:
                progress(result)
            said = watch.look(time.monotonic(), result.reason)
            if said and warn is not None:
                warn("; ".join([said, *follower.remedies()]))
    except InputError as error:
        problem = error.problem if error.file else "; ".join([error.problem, *follower.remedies()])
        raise InputError(problem, file=error.file or video, field=error.field, expected=error.expected) from error
    known = KnownBefore(*follower.told, rigid=angle is not None)
    pooled = pool(seen, follower.shared, following.order, follower.prior, known)
    shape = _shape(seen, pooled, follower.geometry, declaration)
    remarks = (*_remarks(seen, pooled), *_scale_finding(shape, pooled, declaration))
    remarks = (*remarks, *_slowed(follower.repeats.again, shape))
    if past := sum(frame >= len(seen) for frame in follower.verdicts):
        remarks = (*remarks, f"{past} frames of the proofreading are not in the video: its last one is {len(seen) - 1}")
    return Tracking(shape, tuple(seen), pooled, remarks)


def motor_angle(motor: MotorSignal | None, t: Array) -> Array:
    """The motor's angle [rad] at times t (T,); 0 where there is no log."""
    angle = _angle(motor)
    return np.zeros(len(t)) if angle is None else np.array([angle(float(time)) for time in t])


def _angle(motor: MotorSignal | None) -> Callable[[float], float] | None:
    if motor is None:
        return None
    known = np.isfinite(motor.t) & np.isfinite(motor.angle)
    if not known.any():
        return None
    times, angles = motor.t[known], motor.angle[known]
    return lambda t: float(np.interp(t, times, angles))


def _shape(seen: list[TrackedFrame], pooled: Pooled, geometry: Geometry, declaration: Declaration) -> ShapeTrack:
    """The frames' shapes. An undeclared tip may move the scale by +- tip_untold, so that its variance is a third of
    tip_untold^2 larger.
    """
    assert declaration.camera is not None
    axes = np.array([geometry.normal, geometry.arm])
    return ShapeTrack(
        t=np.array([frame.t for frame in seen]),
        coefficients=pooled.x,
        covariance=pooled.covariance,
        accepted=np.array([frame.accepted for frame in seen]),
        reason=tuple(frame.reason for frame in seen),
        scale=float(1.0 + pooled.shared[2]),
        scale_sigma=float(np.sqrt(pooled.shared_covariance[2, 2] + tip_untold(declaration) ** 2 / 3.0)),
        base_shift=axes @ pooled.shared[:2] * declaration.camera.metres_per_px,
        by_frames=pooled.by_frames,
    )


def _slowed(again: int, shape: ShapeTrack) -> tuple[str, ...]:
    """A remark if many pictures of a film repeat the one before."""
    count = len(shape.t)
    if again <= SHOWN_AGAIN * count:
        return ()
    return (
        f"{again} of {count} pictures repeat the one before: the film was slowed or converted; its true frame rate is"
        f" about {(count - again) / count:.2f} of the file's, and each shape occurs as often as its picture",
    )


def tip_untold(declaration: Declaration) -> float:
    """How far the scale may be off at most because the tip's shape is not declared; 0 where it is."""
    assert declaration.camera is not None
    if declaration.specimen.tip_rounding is not None:
        return 0.0
    return TIP_UNTOLD * declaration.camera.metres_per_px / declaration.specimen.length


def _scale_finding(shape: ShapeTrack, pooled: Pooled, declaration: Declaration) -> tuple[str, ...]:
    """A remark if the length differs from the declared one by more than its standard deviation allows."""
    off, untold = shape.scale - 1.0, tip_untold(declaration)
    seen = np.sqrt(pooled.shared_covariance[2, 2])
    if not abs(off) > max(SURE * seen + untold, WORTH_SAYING):
        return ()
    more, length = "longer" if off > 0 else "shorter", declaration.specimen.length
    measured = f"the arm measures {abs(off):.2%} {more} than declared (+- {shape.scale_sigma:.2%})"
    section = declaration.specimen.section
    tip = float(section.half_thickness(1.0)) if isinstance(section, Cone) else 0.0
    if abs(off * length - tip) < CAP_ALIKE * tip:
        return (
            f"{measured}, {1e3 * off * length:.1f} mm, as much as the tip's radius: length_m goes to the end of the"
            " silicone, a rounded tip included",
        )
    return (
        f"{measured}, {1e3 * abs(off) * length:.1f} mm: check m_per_px, and whether length_m includes the"
        " rounded tip of the silicone",
    )


def _remarks(seen: list[TrackedFrame], pooled: Pooled) -> tuple[str, ...]:
    """Remarks for the user: gaps, repeats, too few coordinates, a wrong scale."""
    remarks = []
    reasons = [frame.reason for frame in seen if frame.reason]
    for reason in sorted(set(reasons)):
        remarks.append(f"{reasons.count(reason)} of {len(seen)} frames rejected: {reason}")
    steps = np.diff([frame.t for frame in seen])
    if len(steps):
        dropped = int(np.sum(np.rint(steps / np.median(steps)) - 1))
        if dropped > 0:
            remarks.append(f"{dropped} frames are missing between the time stamps")
    if pooled.result is PoolResult.MAX_TURNS:
        remarks.append(f"{pooled.result.message} Its stated errors may be wrong")
    left, last = (pooled.evidence.get(order, 0.0) for order in (pooled.order, pooled.order - 1))
    if pooled.order == len(seen[0].x) - 1 and last > COORDINATE_PENALTY:
        remarks.append(
            f"the shapes need all {pooled.order} coordinates and may need more: the stated errors are"
            f" {np.sqrt(last):.1f} times those of the edges"
        )
    if left > COORDINATE_PENALTY * (len(seen[0].x) - 1 - pooled.order):
        remarks.append(
            f"the video shows more curvature than order {pooled.order} can follow: chi-square {left:.0f} per frame"
        )
    return tuple(remarks)
