"""The camera's delay from servo taps: where no LED can be in the picture, the arm itself is the signal.

The base is turned to and fro quickly; the arm's root, as the camera sees it, turns with the servo and lags behind by
the camera's delay alone, however soft the arm.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from rig.board import Board
from rig.camera import Camera, CameraFrame
from rig.camera_offset import LARGEST_OFFSET, CameraOffset
from rig.fault import Fault
from rig.motion import motion_of
from rig.play import PlayEnd, PlayStart, play
from rig.protocol import NO_ANGLE, ServoSample
from rig.setup_file import RigSetup
from rig.stills import encode_video
from tentacle.errors import InputError
from tentacle.signals import Array
from tentacle.waveform import Multisine
from vision.track import track

SECONDS = 8.0
FREQUENCIES = (1.1, 1.7, 2.3)  # Hz, no multiples of one another: no delay looks like another
SWING = 0.12  # rad, each
LEAST_SWING = 0.02  # rad rms that the camera must see
FEWEST_FRAMES = 30


def delay(frame_times: Array, seen: Array, servo_times: Array, servo: Array) -> CameraOffset:
    """How much later angles seen (N,) [rad] at frame_times (N,) [s] are than the servo's (M,), on the same time base.

    Least squares of seen = a + b servo(t - delay) over a, b and the delay: the camera may be turned or mirrored.
    Fault("camera") where the arm is not seen to follow the servo.
    """
    good = np.isfinite(seen)
    frame_times, seen = frame_times[good], seen[good]
    grid = np.arange(-0.05, LARGEST_OFFSET, 1e-3)
    inside = (frame_times > servo_times[0] + LARGEST_OFFSET) & (frame_times < servo_times[-1] - 0.05)
    if inside.sum() < FEWEST_FRAMES:
        raise Fault("camera", f"the arm was seen in {int(inside.sum())} frames; {FEWEST_FRAMES} are the least")
    wanted = seen[inside] - seen[inside].mean()
    left = np.empty_like(grid)
    for k, late in enumerate(grid):
        then = np.interp(frame_times[inside] - late, servo_times, servo)
        then -= then.mean()
        left[k] = np.sum((wanted - then * (then @ wanted) / max(float(then @ then), 1e-12)) ** 2)
    best = int(np.argmin(left))
    if wanted.std() < LEAST_SWING or left[best] > 0.2 * np.sum(wanted**2) or not 0 < best < len(grid) - 1:
        raise Fault("camera", "the arm is not seen to follow the servo: is it in the picture, and the scale declared?")
    curvature = (left[best - 1] - 2 * left[best] + left[best + 1]) / 1e-6
    shift = 0.5 * 1e-3 * (left[best - 1] - left[best + 1]) / (left[best - 1] - 2 * left[best] + left[best + 1])
    variance = left[best] / (inside.sum() - 3)
    return CameraOffset(float(grid[best] + shift), float(np.sqrt(2 * variance / curvature)), int(inside.sum()))


def delay_by_taps(setup: RigSetup, board: Board, camera: Camera) -> CameraOffset:
    """Moves the servo for SECONDS and finds the camera's delay; the arm ends at neutral.

    Fault where the run does not complete or the arm is not seen; InputError where no camera is declared, or the limits
    forbid the motion.
    """
    declared = setup.recording.declaration
    if declared.camera is None:
        raise InputError("no camera is declared", field="recording.camera", expected="fps, m_per_px, base_px, arm_px")
    room = min(setup.limits.max_angle, -setup.limits.min_angle) / (3 * SWING)
    pace = setup.limits.max_speed / (2 * np.pi * sum(FREQUENCIES) * SWING)
    swing = SWING * min(1.0, 0.9 * room, 0.9 * pace)
    taps = motion_of(Multisine((swing,) * 3, FREQUENCIES, (0.0, 0.0, 0.0)), SECONDS, setup.limits, {})
    camera.take()
    frames: list[CameraFrame] = []
    servo: list[ServoSample] = []
    for item in play(board, taps.points, setup.limits, period=taps.period):
        if isinstance(item, PlayEnd):
            if item.outcome != "complete":
                raise Fault("camera", f"the taps ended as {item.outcome}: {item.words}")
        elif not isinstance(item, PlayStart):
            servo += [sample for sample in item if isinstance(sample, ServoSample)]
        frames += camera.take()
    fit = board.clock.fit()
    times = np.array([fit.to_board(frame.host_s) for frame in frames])
    servo_times = np.array([1e-6 * sample.board_us for sample in servo])
    angles = 1e-6 * np.array([s.command_urad if s.angle_urad == NO_ANGLE else s.angle_urad for s in servo])
    if len(times) < FEWEST_FRAMES:
        raise Fault("camera", f"the camera gave {len(times)} frames")
    with tempfile.TemporaryDirectory() as folder:
        video = Path(folder) / "taps.mp4"
        encode_video(times - times[0], [frame.jpeg for frame in frames], video)
        shape = track(video, declared, None)
    seen = np.where(shape.accepted, shape.coefficients[:, 0], np.nan)
    return delay(shape.t + times[0], seen, servo_times, angles)
