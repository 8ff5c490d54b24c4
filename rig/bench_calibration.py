"""Calibrations with a person: masses hung on the load cell, angles measured, a lamp or taps filmed. Each returns the
setup with the new calibration. `say` shows a line, `ask` asks a question and returns the answer.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from rig.board import Board
from rig.calibrate import camera_offset, camera_scale, fit_line, load_cell_calibration, read_cell, servo_calibration
from rig.connection import connected, opened_camera
from rig.fault import Fault
from rig.play import PlayEnd, play
from rig.safety import set_points
from rig.servo_tap import delay_by_taps
from rig.setup_file import RigSetup
from tentacle.errors import InputError
from tentacle.specimen import STANDARD_GRAVITY
from tentacle.waveform import Rest

Say = Callable[[str], None]
Ask = Callable[[str, Board], str]


def calibrated_load_cell(
    setup: RigSetup, masses: Sequence[float], seconds: float, *, pulls_back: bool, say: Say, ask: Ask
) -> RigSetup:
    """From known masses [kg], each read for `seconds`; pulls_back: they pull along -y."""
    if len(set(masses)) < 3 or min(masses) < 0:
        raise InputError(
            f"{len(set(masses))} different masses", field="--masses", expected="three or more, 0 among them"
        )
    forces = [(-1.0 if pulls_back else 1.0) * mass * STANDARD_GRAVITY for mass in masses]
    means = []
    with connected(setup) as board:
        for mass in masses:
            ask(f"hang {1e3 * mass:g} g on the load cell and let it come to rest", board)
            reading = read_cell(board, seconds)
            means.append(reading.mean)
            spread = f"{reading.mean:12.1f} +- {reading.deviation:.1f} counts"
            say(f"{1e3 * mass:8.1f} g  {spread}, {reading.count} readings")
    fit = fit_line(np.array(forces), np.array(means))
    for mass, residual in zip(masses, fit.residuals, strict=True):
        say(f"{1e3 * mass:8.1f} g  residual {1e3 * residual:+.3f} mN")
    say(f"{fit.slope:.1f} +- {fit.slope_sigma:.1f} counts/N, offset {fit.offset:.1f} +- {fit.offset_sigma:.1f} counts")
    return replace(setup, load_cell=load_cell_calibration(fit))


def calibrated_servo(setup: RigSetup, angles: Sequence[float], seconds: float, *, say: Say, ask: Ask) -> RigSetup:
    """From angles [rad] measured at set points, each held for `seconds`."""
    if len(set(angles)) < 2:
        raise InputError("one angle gives no line", field="--angles", expected="two different ones or more")
    motions = [set_points(Rest(angle), seconds, setup.limits) for angle in angles]
    measured = []
    with connected(setup) as board:
        for angle, points in zip(angles, motions, strict=True):
            say(f"to {angle:g} rad for {seconds:g} s: measure the angle there")
            for item in play(board, points, setup.limits):
                if isinstance(item, PlayEnd) and item.outcome != "complete":
                    raise Fault("no_answer", f"the move to {angle:g} rad ended as {item.outcome}: {item.words}")
            answer = ask("the angle measured [rad]", board)
            try:
                measured.append(float(answer))
            except ValueError:
                raise InputError(f"{answer!r} is no angle", expected="a number [rad]") from None
    servo = servo_calibration(np.array(angles), np.array(measured), setup.servo)
    say(f"centre {servo.centre_us:.1f} us, {servo.us_per_rad:.1f} us/rad")
    return replace(setup, servo=servo)


def calibrated_scale(setup: RigSetup, points: Sequence[float], metres: float, *, say: Say) -> RigSetup:
    """From two points (u1, v1, u2, v2) [px] that lie `metres` apart."""
    camera = setup.recording.declaration.camera
    if camera is None:
        raise InputError("no camera is declared", field="recording.camera", expected="a [recording.camera] table")
    scale = camera_scale(points[:2], points[2:], metres)
    say(f"{1e3 * scale:.5f} mm/px (was {1e3 * camera.metres_per_px:.5f})")
    declaration = replace(setup.recording.declaration, camera=replace(camera, metres_per_px=scale))
    return replace(setup, recording=replace(setup.recording, declaration=declaration))


def calibrated_offset(setup: RigSetup, flashes: int, *, tap: bool, say: Say) -> RigSetup:
    """The camera's delay, from flashes of the board's LED, or from servo taps."""
    with connected(setup) as board, opened_camera(setup, board.time) as camera:
        if camera is None or setup.camera is None:
            raise InputError("no camera is named", field="camera.source", expected="a camera to open")
        if tap:
            found, count = delay_by_taps(setup, board, camera), "frames"
        else:
            found, count = camera_offset(board, camera, flashes), "edges"
    delay = f"{1e3 * found.offset:.2f} +- {1e3 * found.sigma:.2f} ms"
    say(f"frames arrive {delay} after exposure ({found.used} {count})")
    return replace(setup, camera=replace(setup.camera, offset=found.offset, sigma=found.sigma))
