"""Bodies of `tentacle rig`: ports, check, calibrate, emulate, import."""

from __future__ import annotations

import argparse
import signal
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from tentacle.errors import InputError

if TYPE_CHECKING:
    from rig.emulator import Emulator

LATE = 0.25  # s; the board's watchdog bites then


def ports(_arguments: argparse.Namespace) -> int:
    """The serial ports, the Due's marked."""
    from rig.link import ports as found_ports

    found = found_ports()
    for port in found:
        print(f"{port.device}  {port.description}{'  <- Arduino Due, programming port' if port.due else ''}")
    if not found:
        print("no serial port is there; without hardware: tentacle rig emulate FOLDER")
    return 0


def check(arguments: argparse.Namespace) -> int:
    """The findings, one a line; exit code 3 where one is not good enough."""
    import json
    from dataclasses import asdict

    from rig.check import check as findings
    from rig.connection import connected, opened_camera
    from rig.setup_file import read_setup

    setup = read_setup(arguments.rig)
    with connected(setup) as board, opened_camera(setup, board.time) as camera:
        items = findings(setup, board, camera)
    if arguments.json:
        print(json.dumps([asdict(item) for item in items], indent=1))
    else:
        for item in items:
            words = "" if item.good or not item.words else f"  <- {item.words}"
            print(f"{'ok ' if item.good else 'NOT'}  {item.name:32s} {item.value:10.4g} {item.unit}{words}")
    return 0 if all(item.good for item in items) else 3


def calibrate(arguments: argparse.Namespace) -> int:
    """Calibrates one part and writes it into RIG.toml."""
    from rig.setup_file import read_setup, write_setup

    setup = read_setup(arguments.rig)
    parts = {
        "load-cell": _calibrate_load_cell,
        "servo": _calibrate_servo,
        "camera-scale": _calibrate_scale,
        "camera-offset": _calibrate_offset,
    }
    write_setup(parts[arguments.part](arguments, setup), arguments.rig)
    print(f"wrote {arguments.rig}")
    return 0


def _calibrate_load_cell(arguments, setup):
    import numpy as np

    from rig.calibrate import fit_line, load_cell_calibration, read_cell
    from rig.connection import connected
    from tentacle.specimen import STANDARD_GRAVITY

    if len(set(arguments.masses)) < 3 or min(arguments.masses) < 0:
        raise InputError(
            f"{len(set(arguments.masses))} different masses", field="--masses", expected="three or more, 0 among them"
        )
    sign = -1.0 if arguments.pulls_back else 1.0
    forces = [sign * mass * STANDARD_GRAVITY for mass in arguments.masses]
    means = []
    with connected(setup) as board:
        for mass in arguments.masses:
            _ask(f"hang {1e3 * mass:g} g on the load cell, let it come to rest", board)
            reading = read_cell(board, arguments.seconds)
            means.append(reading.mean)
            print(
                f"{1e3 * mass:8.1f} g  {reading.mean:12.1f} +- {reading.deviation:.1f} counts, {reading.count} readings"
            )
    fit = fit_line(np.array(forces), np.array(means))
    for mass, residual in zip(arguments.masses, fit.residuals, strict=True):
        print(f"{1e3 * mass:8.1f} g  residual {1e3 * residual:+.3f} mN")
    print(
        f"{fit.slope:.1f} +- {fit.slope_sigma:.1f} counts/N, offset {fit.offset:.1f} +- {fit.offset_sigma:.1f} counts"
    )
    return replace(setup, load_cell=load_cell_calibration(fit))


def _calibrate_servo(arguments, setup):
    import numpy as np

    from rig.calibrate import servo_calibration
    from rig.connection import connected
    from rig.fault import Fault
    from rig.play import PlayEnd, play
    from rig.safety import set_points
    from tentacle.waveform import Rest

    if len(set(arguments.angles)) < 2:
        raise InputError("one angle gives no line", field="--angles", expected="two different ones or more")
    motions = [set_points(Rest(angle), arguments.seconds, setup.limits) for angle in arguments.angles]
    measured = []
    with connected(setup) as board:
        for angle, points in zip(arguments.angles, motions, strict=True):
            print(f"to {angle:g} rad for {arguments.seconds:g} s: measure the angle there", flush=True)
            for item in play(board, points, setup.limits):
                if isinstance(item, PlayEnd) and item.outcome != "complete":
                    raise Fault("no_answer", f"the move to {angle:g} rad ended as {item.outcome}: {item.words}")
            answer = _ask("the angle measured [rad]", board)
            try:
                measured.append(float(answer))
            except ValueError:
                raise InputError(f"{answer!r} is no angle", expected="a number [rad]") from None
    servo = servo_calibration(np.array(arguments.angles), np.array(measured), setup.servo)
    print(f"centre {servo.centre_us:.1f} us, {servo.us_per_rad:.1f} us/rad")
    return replace(setup, servo=servo)


def _calibrate_scale(arguments, setup):
    from rig.calibrate import camera_scale

    camera = setup.recording.declaration.camera
    if camera is None:
        raise InputError("no camera is declared", file=arguments.rig, field="recording.camera")
    scale = camera_scale(arguments.points[:2], arguments.points[2:], arguments.metres)
    print(f"{1e3 * scale:.5f} mm/px (was {1e3 * camera.metres_per_px:.5f})")
    declaration = replace(setup.recording.declaration, camera=replace(camera, metres_per_px=scale))
    return replace(setup, recording=replace(setup.recording, declaration=declaration))


def _calibrate_offset(arguments, setup):
    from rig.calibrate import camera_offset
    from rig.connection import connected, opened_camera
    from rig.servo_tap import delay_by_taps

    with connected(setup) as board, opened_camera(setup, board.time) as camera:
        if camera is None:
            raise InputError("no camera is named", file=arguments.rig, field="camera.source")
        if arguments.tap:
            found, count = delay_by_taps(setup, board, camera), "frames"
        else:
            found, count = camera_offset(board, camera, arguments.flashes), "edges"
    print(f"frames arrive {1e3 * found.offset:.2f} +- {1e3 * found.sigma:.2f} ms after exposure ({found.used} {count})")
    return replace(setup, camera=replace(setup.camera, offset=found.offset, sigma=found.sigma))


def _ask(question: str, board) -> str:
    """Asks on the terminal while the board goes on hearing from us."""
    import threading

    answers: list[str] = []
    print(f"{question}; then Enter: ", end="", flush=True)
    thread = threading.Thread(target=lambda: answers.append(sys.stdin.readline()), daemon=True)
    thread.start()
    while thread.is_alive():
        board.service(0.02)
    if not answers or not answers[0]:
        raise InputError("the terminal gave no answer", expected="a line on standard input")
    return answers[0].strip()


def emulate(arguments: argparse.Namespace) -> int:
    """Runs until Ctrl-C or a polite kill, both of which a shell may have ignored for us; the board ends with it."""
    for name in (signal.SIGINT, signal.SIGTERM):
        signal.signal(name, signal.default_int_handler)
    from rig.emulator import Emulator
    from rig.setup_file import write_setup

    if arguments.hidden is not None and arguments.model is None:
        raise InputError("needs an arm to hide in", field="--hidden", expected="--model with it")
    setup, settings = _emulated(arguments)
    with Emulator(arguments.folder, settings) as running:
        if arguments.line is not None:
            running.say("line", *arguments.line)
        write_setup(setup, arguments.folder / "rig.toml")
        print(
            f"port {running.url}; in another terminal: tentacle rig check {arguments.folder / 'rig.toml'}", flush=True
        )
        late = False
        try:
            while running.exit_status() is None:
                time.sleep(0.2)
                if not late and _behind(running) > LATE:
                    late = True
                    print("this computer is too busy: the board falls behind its clock; try --rate", file=sys.stderr)
        except KeyboardInterrupt:
            print("ended")
            return 0
    raise InputError("the emulated board has ended", file=arguments.folder)


def _behind(running: Emulator) -> float:
    """How far the emulated board is behind its own clock [s of it]; 0 where it cannot be told."""
    try:
        truth = running.truth()
    except InputError:
        return 0.0
    return truth.board_time(time.monotonic()) - 1e-6 * truth.board_us


def _emulated(arguments):
    from rig.emulator import EmulatorSettings
    from rig.safety import SafetyLimits
    from rig.settle import SettleRule
    from rig.setup_file import CameraSettings, LoadCellCalibration, RigSetup
    from tentacle.io.declaration_file import RecordingFile
    from tentacle.io.model_file import read_model
    from tentacle.recording import Camera, Declaration
    from tentacle.specimen import WATER, Cone, Specimen

    camera = Camera(30.0, 0.0008, (160.0, 24.0), (0.0, 1.0), exposure=0.008)
    declaration = Declaration(Specimen(Cone(0.0125, 0.001), 0.14, 1070.0), WATER, camera=camera)
    settings = EmulatorSettings(seed=arguments.seed, rate=arguments.rate)
    if arguments.model is not None:
        model = read_model(arguments.model)
        declaration = Declaration(model.specimen, model.fluid, model.gravity, camera=camera)
        words = [str(path.resolve()) for path in (arguments.model, arguments.hidden) if path is not None]
        settings = replace(settings, plant="arm", plant_options=tuple(words))
    setup = RigSetup(
        port=str(arguments.folder / "port"),
        limits=SafetyLimits(min_angle=-0.8, max_angle=0.8, max_speed=8.0, max_current=0.9),
        settle=SettleRule(threshold=2e-3, samples=100, timeout=60.0),
        load_cell=LoadCellCalibration(settings.cell_offset, settings.counts_per_newton),
        recording=RecordingFile(declaration),
        camera=None if arguments.no_camera else CameraSettings("emulated"),
        rate=arguments.rate,
    )
    return setup, settings


def convert(arguments: argparse.Namespace) -> int:
    """A log or a run as an import folder."""
    import tempfile

    from tentacle.io.write_folder import write_folder

    if arguments.log.suffix == ".rrd":
        from rig.run_file import read_run, to_recording

        with tempfile.TemporaryDirectory() as folder:
            run = read_run(arguments.log)
            write_folder(to_recording(run, video=Path(folder) / "video.mp4"), arguments.out)
        print(f"wrote {arguments.out}; the run was {run.outcome}")
        if run.missing:
            print(run.missing)
        return 0
    recording, words = _bench_recording(arguments)
    write_folder(recording, arguments.out)
    print(words)
    print(f"wrote {arguments.out}")
    return 0


def _bench_recording(arguments):
    from rig.bench_log import LogColumns, calibration_of, load_cell_signal, read_bench_log
    from rig.calibrate import load_cell_calibration
    from rig.setup_file import LoadCellCalibration
    from tentacle.io.declaration_file import read_recording_file
    from tentacle.recording import Recording

    if arguments.declare is None:
        raise InputError("is missing", field="--declare", expected="the recording.toml of what hung on the load cell")
    if arguments.columns is not None and len(arguments.columns) not in (2, 3):
        raise InputError(f"{len(arguments.columns)} names", field="--columns", expected="TIME COUNTS [GRAMS]")
    declared = read_recording_file(arguments.declare)
    log = read_bench_log(arguments.log, LogColumns(*arguments.columns) if arguments.columns else None)
    low, high = (1e3 * x for x in log.jitter)
    words = f"{len(log.t)} readings at {log.rate:.1f} Hz, {low:.0f} to {high:.0f} ms apart (5 to 95 %)"
    if arguments.calibration is not None:
        calibration = LoadCellCalibration(*arguments.calibration)
    else:
        fit = calibration_of(log)
        calibration = load_cell_calibration(fit)
        words += (
            f"; {fit.slope:.1f} +- {fit.slope_sigma:.2g} counts/N, offset {fit.offset:.1f}, rms {1e3 * fit.rms:.3g} mN"
        )
    notes = {**declared.notes, "source": arguments.log.name}
    recording = Recording(
        declared.name or arguments.log.stem,
        declared.declaration,
        load_cell=load_cell_signal(log, calibration),
        notes=notes,
    )
    return recording, words
