"""The checks of `tentacle rig check`, without moving the arm: whether the rig is ready to measure, and how
accurately.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from rig import command_bodies, protocol
from rig.board import Board
from rig.calibrate import read_cell
from rig.camera import CameraThread
from rig.fault import Fault
from rig.protocol import ServoSample, Type
from rig.setup_file import RigSetup


@dataclass(frozen=True)
class CheckItem:
    """One finding: value in unit, whether it is good enough, and what to do if it is not."""

    name: str
    value: float
    unit: str
    good: bool
    words: str = ""


def check_rig(setup: RigSetup, board: Board, camera: CameraThread | None, seconds: float = 3.0) -> list[CheckItem]:
    """Looks at round trips, clock, limits, load cell, servo feedback and camera of an armed board for some seconds
    each.
    """
    return [
        *_line(board),
        *_limits(setup, board),
        *_cell(setup, board, seconds),
        *_servo(board, seconds),
        *(_camera(board, camera, seconds) if camera is not None else []),
    ]


def _line(board: Board) -> list[CheckItem]:
    fit = board.synchronise(100)
    trips = 1e3 * board.clock.round_trips()
    slow = float(np.quantile(trips, 0.95))
    bad = board.counters.host_bad_frames + board.counters.board_bad_frames
    return [
        CheckItem("round trip, median", float(np.median(trips)), "ms", True),
        CheckItem(
            "round trip, 95 %", slow, "ms", slow < 50, "over 50 ms the watchdog comes near: another cable or port?"
        ),
        CheckItem(
            "clock, 1 sigma", 1e3 * fit.sigma, "ms", fit.sigma < 1e-3, "over 1 ms: the line's delays vary too much"
        ),
        CheckItem("clock, skew", 1e6 * fit.skew, "ppm", abs(fit.skew) < 3e-4, "over 300 ppm: a resonator, no crystal?"),
        CheckItem("damaged frames", bad, "", bad == 0, "the line is disturbed: shield it, shorten it"),
    ]


def _limits(setup: RigSetup, board: Board) -> list[CheckItem]:
    """The board must refuse a set point beyond the limits. The check sends one, at neutral, without a run."""
    board.command(Type.CLEAR)
    beyond = round(1e6 * setup.limits.max_angle) + 10_000
    try:
        board.command(Type.POINTS, command_bodies.points(0, [beyond]))
        refused = False
    except Fault as fault:
        refused = fault.kind == "refused"
    board.command(Type.CLEAR)
    within = setup.limits.neutral_time
    return [
        CheckItem(
            "limits obeyed by the board", float(refused), "", refused, "it took a point beyond them: do not run it"
        ),
        CheckItem("neutral after silence, at worst", within, "s", within <= 0.5),
    ]


def _cell(setup: RigSetup, board: Board, seconds: float) -> list[CheckItem]:
    reading = read_cell(board, seconds)
    noise = reading.deviation / abs(setup.load_cell.slope)
    threshold = setup.settle.threshold
    return [
        CheckItem(
            "load cell, rate", reading.rate, "Hz", reading.rate > 80, "10 Hz: tie the HX711's RATE pin to supply"
        ),
        CheckItem(
            "load cell, noise", 1e3 * noise, "mN", noise < threshold, f"over the settling threshold of {threshold:g} N"
        ),
        CheckItem("load cell, at rest", float(setup.load_cell.to_newtons(reading.mean)), "N", True),
    ]


def _servo(board: Board, seconds: float) -> list[CheckItem]:
    board.take()
    until = board.time.now() + seconds
    samples: list[ServoSample] = []
    while board.time.now() < until:
        board.service()
        samples += [s for s in board.take() if isinstance(s, ServoSample)]
    if len(samples) < 3:
        return [CheckItem("servo, frames", 0.0, "Hz", False, "no servo frame came")]
    rate = 1e6 / float(np.median(np.diff([s.board_us for s in samples])))
    angles = np.array([s.angle_urad for s in samples if s.angle_urad != protocol.NO_ANGLE], dtype=float)
    items = [CheckItem("servo, frames", rate, "Hz", abs(rate - 50) < 1)]
    if angles.size:
        off = 1e-3 * float(np.abs(angles).mean())
        items.append(CheckItem("servo, off neutral", off, "mrad", off < 20, "calibrate the servo's centre"))
    else:
        items.append(CheckItem("servo, feedback", 0.0, "", True, "none: the commanded angle will be recorded"))
    return items


def _camera(board: Board, camera: CameraThread, seconds: float) -> list[CheckItem]:
    camera.take()
    times: list[float] = []
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        board.service()
        times += [frame.host_s for frame in camera.take()]
    if len(times) < 3:
        return [CheckItem("camera, frames", 0.0, "1/s", False, "no frame came")]
    spacing = np.diff(times)
    period = float(np.median(spacing))
    dropped = int(np.sum(spacing > 1.6 * period))
    return [
        CheckItem("camera, frames", 1.0 / period, "1/s", True),
        CheckItem("camera, jitter", 1e3 * float(np.std(spacing[spacing < 1.6 * period])), "ms", True),
        CheckItem(
            "camera, dropped frames", dropped, "", dropped == 0, "more light, a smaller picture, or a faster port"
        ),
    ]
