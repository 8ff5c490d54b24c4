"""The camera's delay from servo taps: without an LED in the picture, the arm itself is the signal. The base is turned
to and fro. In the film the arm's root turns with the servo, later by the camera's delay. Only the root is used, and a
slow motion: the outer parts of the arm bend and lag by as much as the camera, and a shape of the whole arm, or a fast
motion, would add some of this lag to the base angle.
"""

from __future__ import annotations

import cv2
import numpy as np

from rig.board import Board
from rig.camera import CameraFrame, CameraThread, Image
from rig.camera_offset import LARGEST_OFFSET, CameraOffset
from rig.fault import Fault
from rig.motion import rig_motion
from rig.play import PlayEnd, PlayStart, play
from rig.protocol import NO_ANGLE, ServoSample
from rig.setup_file import RigSetup
from tentacle.errors import InputError
from tentacle.recording import Declaration
from tentacle.signals import Array
from tentacle.waveform import Multisine

TAP_SECONDS = 8.0
TAP_FREQUENCIES = (0.4, 0.65, 0.9)  # Hz, no multiples of each other, so that the delay is unique
TAP_SWING = 0.16  # rad, each
LEAST_SWING = 0.02  # rad rms, least motion in the film
FEWEST_TAP_FRAMES = 30
ROOT = (0.04, 0.25)  # of the length: the part that gives the root's direction
BEND = 1e-3  # s; error from the bending of the root of a soft cone in water (1.2 ms at worst, MuJoCo)
BESIDE = 3.0  # root half thicknesses to either side
LEAST_GREY_STEP = 25.0  # grey levels between arm and ground


def root_angle(image: Image, declared: Declaration, about: float = 0.0) -> float:
    """The direction of the arm's root [rad] in a grey picture (height, width), from the declared arm's; NaN if unseen.

    On lines across the direction `about` [rad] the darkness has a centre; a parabola through the centres has the
    root's direction at the base: what is bent is bent by a curvature, and adds nothing there.
    """
    assert declared.camera is not None
    length, aside = declared.specimen.length, BESIDE * float(declared.specimen.section.half_thickness(np.zeros(1))[0])
    along, across = np.linspace(ROOT[0] * length, ROOT[1] * length, 24), np.linspace(-aside, aside, 241)
    normal, arm = np.array([np.cos(about), np.sin(about)]), np.array([-np.sin(about), np.cos(about)])
    pixels = declared.camera.to_pixels(across[:, None] * normal + along[:, None, None] * arm).astype(np.float32)
    lines = cv2.remap(image, pixels[..., 0], pixels[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    level, _ = cv2.threshold(lines, 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU)
    below = lines <= level
    if below.all() or not below.any():
        return float("nan")
    light, dark = float(lines[~below].mean()), float(lines[below].mean())
    darkness = np.clip((light - lines.astype(float)) / max(light - dark, 1.0), 0.0, 1.0)
    weight = darkness.sum(axis=1)
    if light - dark < LEAST_GREY_STEP or weight.min() < 1.0:
        return float("nan")
    return about - float(np.arctan(np.polyfit(along, darkness @ across / weight, 2)[1]))


def delay(frame_times: Array, seen: Array, servo_times: Array, servo: Array) -> CameraOffset:
    """Delay of the measured angles (N,) [rad] at frame_times (N,) [s] against the servo's (M,), on the same time base.

    Least squares of seen = a + b servo(t - delay) over a, b and the delay: the camera may be turned or mirrored.
    Fault("camera") where the arm is not seen to follow the servo.
    """
    good = np.isfinite(seen)
    frame_times, seen = frame_times[good], seen[good]
    grid = np.arange(-0.05, LARGEST_OFFSET, 1e-3)
    inside = (frame_times > servo_times[0] + LARGEST_OFFSET) & (frame_times < servo_times[-1] - 0.05)
    if inside.sum() < FEWEST_TAP_FRAMES:
        raise Fault("camera", f"the arm was seen in {int(inside.sum())} frames; {FEWEST_TAP_FRAMES} are the least")
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
    sigma = float(np.hypot(np.sqrt(2 * variance / curvature), BEND))
    return CameraOffset(float(grid[best] + shift), sigma, int(inside.sum()))


def delay_by_taps(setup: RigSetup, board: Board, camera: CameraThread) -> CameraOffset:
    """Moves the servo for SECONDS and finds the camera's delay; the arm ends at neutral.

    Fault where the run does not complete, the board has no feedback of the servo's angle, or the arm is not seen;
    InputError where no camera is declared, or the limits forbid the motion.
    """
    declared = setup.recording.declaration
    if declared.camera is None:
        raise InputError("no camera is declared", field="recording.camera", expected="fps, m_per_px, base_px, arm_px")
    room = min(setup.limits.max_angle, -setup.limits.min_angle) / (3 * TAP_SWING)
    pace = setup.limits.max_speed / (2 * np.pi * sum(TAP_FREQUENCIES) * TAP_SWING)
    swing = TAP_SWING * min(1.0, 0.9 * room, 0.9 * pace)
    taps = rig_motion(Multisine((swing,) * 3, TAP_FREQUENCIES, (0.0, 0.0, 0.0)), TAP_SECONDS, setup.limits, {})
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
    if any(sample.angle_urad == NO_ANGLE for sample in servo):
        raise Fault(
            "camera", "the servo's own lag cannot be told from the camera's without its angle (kFeedback): use the LED"
        )
    fit = board.clock.fit()
    times = np.array([fit.to_board(frame.host_s) for frame in frames])
    servo_times = np.array([1e-6 * sample.board_us for sample in servo])
    angles = 1e-6 * np.array([sample.angle_urad for sample in servo])
    seen = np.full(len(frames), np.nan)
    for k, frame in enumerate(frames):
        image = _grey(frame)
        first = root_angle(image, declared)
        seen[k] = root_angle(image, declared, first) if np.isfinite(first) else first
    return delay(times, seen, servo_times, angles)


def _grey(frame: CameraFrame) -> Image:
    return np.asarray(cv2.imdecode(np.frombuffer(frame.jpeg, np.uint8), cv2.IMREAD_GRAYSCALE), dtype=np.uint8)
